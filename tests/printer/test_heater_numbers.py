"""H of M301 to M307 and T of reports: hotends are numbered as the tools that they serve."""

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.heater_numbers import number_of

TEXT = config.shipped_text("dual-extruder")
FIRST, SECOND = 'heater = "hotend"\n', 'heater = "hotend1"\n'
CROSSED = TEXT.replace(FIRST, "?").replace(SECOND, FIRST).replace("?", SECOND)
SHARED = TEXT.replace(FIRST, f'{FIRST}\n[[tools]]\nextruder = "e"\n{FIRST}')
TWO_BEDS = TEXT.replace('[heaters.hotend1]\nkind = "hotend"', '[heaters.hotend1]\nkind = "bed"')
TWO_BEDS = TWO_BEDS.replace(SECOND, FIRST)


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        (TEXT, {"hotend": 0, "hotend1": 1, "bed": -1}),
        (CROSSED, {"hotend": 1, "hotend1": 0, "bed": -1}),
        (SHARED, {"hotend": 0, "hotend1": 2, "bed": -1}),
        (TWO_BEDS, {"hotend": 0, "hotend1": -1, "bed": None}),
    ],
)
def test_reported_settings_apply_to_the_same_heaters(text, numbers):
    machine = config.load_text(text)
    assert {name: number_of(machine, name) for name in machine.heaters} == numbers
    with Scenario(machine) as s:
        controls = s.printer.heat.controls
        for number in (n for n in numbers.values() if n is not None):
            s.host.ok(f"M301 H{number} P{20 + number}")
            s.host.ok(f"M305 H{number} B{4000 + number}")
        before = {n: (controls.control(n), controls.sensors[n]) for n in machine.heaters}
        for name, number in numbers.items():
            if number is not None:
                assert before[name][0].kp == 20 + number
        for line in s.host.ok("M503")[:-1]:
            s.host.send(line)
        s.passes(5)
        after = {n: (controls.control(n), controls.sensors[n]) for n in machine.heaters}
        for name, (control, sensor) in before.items():
            assert after[name][0].kp == pytest.approx(control.kp)
            assert after[name][1] == sensor


@pytest.mark.parametrize(("text", "tool"), [(CROSSED, 0), (CROSSED, 1), (SHARED, 1)])
def test_tool_temperature_is_that_of_its_hotend(text, tool):
    with Scenario(config.load_text(text)) as s:
        s.host.ok(f"T{tool}")
        s.host.ok(f"M104 T{tool} S150")
        s.passes(0.5)
        answer = s.host.ok("M105")[-1]
        hot = [part for part in answer.split(" B:")[0].split(" T") if "150" in part]
        assert answer.split("ok T:")[1].split()[1] == "/150.00"
        assert len(hot) == 2  # the one at work, and its own number
