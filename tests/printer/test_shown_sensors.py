"""Temperature sensors without a heater."""

from __future__ import annotations

import itertools

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.exporting.settings import Sections
from passo.config.load import shipped_text
from passo.errors import ConfigError
from passo.printer.klipper.objects import objects

SENSORS = """[sensors.Chamber]
sensor = "Generic 3950"
sensor_pin = "T2"
min_c = 0.0
max_c = 90.0
letter = "C"
ambient_c = 31.0
[sensors.pi]
sensor = { kind = "host", path = "PATH" }
max_c = 70.0
"""


def machine(path: object = "", *, on_fault: str = "report"):
    sensors = SENSORS.replace("PATH", str(path)).replace(
        "letter", f'on_fault = "{on_fault}"\nletter'
    )
    return config.load_text(shipped_text("i3").replace("[fans.part]", f"{sensors}[fans.part]"))


@pytest.fixture
def s():
    with Scenario(machine()) as s:
        s.passes(2)
        yield s


def seen(s, name: str = "Chamber"):
    return s.printer.status.read().sensors[name]


def test_status_m105_and_clients_show_the_temperature(s):
    assert seen(s).celsius == pytest.approx(31, abs=0.25)
    assert " C:30.84" in s.host.ok("M105")[0]
    shown = objects(s.machine, Sections(s.machine), s.printer.status.read(), {})
    assert shown["temperature_sensor Chamber"]()["temperature"] == pytest.approx(31, abs=0.25)
    assert "temperature_sensor Chamber" in shown["heaters"]()["available_sensors"]


def test_temperature_of_this_computer_comes_from_its_file(tmp_path):
    file = tmp_path / "temp"
    file.write_text("41500\n", encoding="ascii")
    with Scenario(machine(file)) as s:
        assert s.until(lambda: seen(s, "pi").celsius == 41.5, 2)
        file.write_text("72000\n", encoding="ascii")
        s.host.expect(r"sensor pi reads 72.0 C, above its maximum of 70.0 C", 5)
        assert (seen(s, "pi").lowest_c, seen(s, "pi").highest_c) == (41.5, 72.0)
        file.unlink()
        assert s.until(lambda: seen(s, "pi").celsius is None, 2)


@pytest.mark.parametrize(
    ("fault", "text"), [("open", "its cable is open"), ("short", "its cable has a short")]
)
def test_broken_sensor_is_reported_once_and_stops_nothing(s, fault, text):
    s.host.ok(f"SIMULATE_FAULT NAME=Chamber-sensor VALUE={fault}")
    s.host.expect(f"sensor Chamber is broken: {text}", 5)
    s.host.silent(5, "sensor Chamber")
    assert (seen(s).celsius, seen(s).fault) == (None, fault)
    assert " C:-273.15" in s.host.ok("M105")[0]
    s.host.ok("SIMULATE_FAULT NAME=Chamber-sensor VALUE=none")
    assert s.until(lambda: seen(s).fault == "", 2)
    assert seen(s).celsius == pytest.approx(31, abs=0.25)


def test_a_flicker_of_the_sensor_is_not_a_fault(s):
    s.board.force_sensor("Chamber", 1.0)
    s.passes(0.5)
    s.board.force_sensor("Chamber", None)
    s.host.silent(3, "sensor Chamber")


def test_sensor_may_halt_the_printer():
    with Scenario(machine(on_fault="machine")) as s:
        s.passes(2)
        s.host.ok("M140 S50")
        s.board.force_sensor("Chamber", 1.0)
        assert s.until(lambda: bool(s.printer.state.halted), 5)
        assert "sensor Chamber is broken" in s.printer.state.halted
        assert s.printer.rig.connection.heaters["bed"].target == 0
        s.board.force_sensor("Chamber", None)
        s.host.ok("M999", 30)
        assert seen(s).celsius == pytest.approx(31, abs=0.25)


def warms(s, celsius: float) -> None:
    """The chamber gets so warm."""
    rows = s.board.board.sensors[-1].table
    (c0, r0), (c1, r1) = next((a, b) for a, b in itertools.pairwise(rows) if a[0] <= celsius < b[0])
    s.board.force_sensor("Chamber", r0 + (r1 - r0) * (celsius - c0) / (c1 - c0))


@pytest.mark.parametrize(
    "line", ['TEMPERATURE_WAIT SENSOR="temperature_sensor chamber" MINIMUM=45', "M191 S45"]
)
def test_wait_for_the_chamber_ends_when_it_is_warm(s, line):
    s.host.send(line, "M118 warm")
    s.host.silent(20, "^warm|^ok")
    warms(s, 44)
    s.host.silent(5, "^warm")
    warms(s, 46)
    s.host.expect("warm", 2)


def test_m108_ends_a_wait_for_a_sensor(s):
    s.host.send('TEMPERATURE_WAIT SENSOR="temperature_sensor Chamber" MINIMUM=45')
    s.host.silent(5, "^ok")
    s.passes(5)
    s.host.send("M108")
    s.host.expect("^ok", 2)


def test_wait_for_a_broken_sensor_is_refused(s):
    s.host.send("M191 S45")
    s.passes(2)
    s.board.force_sensor("Chamber", 1.0)
    s.host.expect("sensor Chamber is broken: its cable is open", 5)
    s.host.expect("^ok", 2)


def test_wait_for_a_sensor_without_readings_is_refused(s):
    """The file of the sensor does not exist."""
    start = s.loop.time()
    s.host.send('TEMPERATURE_WAIT SENSOR="temperature_sensor pi" MINIMUM=45')
    s.host.expect("sensor pi has given no temperature for 10 s, so it cannot be waited for", 12)
    assert s.loop.time() - start == pytest.approx(10, abs=1)
    s.host.expect("^ok", 1)


def test_wait_for_a_combined_sensor_follows_its_parts():
    both = '[sensors.both]\nsensor = { kind = "combined", of = ["Chamber", "bed"], by = "min" }\n'
    text = shipped_text("i3").replace("[fans.part]", f"{SENSORS}{both}[fans.part]")
    with Scenario(config.load_text(text)) as s:
        s.passes(2)
        s.host.ok("M140 S45")
        s.host.send('TEMPERATURE_WAIT SENSOR="temperature_sensor both" MINIMUM=40', "M118 warm")
        s.host.silent(300, "^warm")
        assert s.printer.rig.connection.heaters["bed"].celsius > 44
        warms(s, 41)
        s.host.expect("warm", 2)


def test_temperature_wait_waits_while_a_heater_cools(s):
    s.host.ok("M190 S50", 300)
    s.host.ok("M140 S0")
    s.host.send("TEMPERATURE_WAIT SENSOR=heater_bed MAXIMUM=45")
    s.host.expect("^ok", 600)
    assert s.printer.rig.connection.heaters["bed"].celsius <= 45


@pytest.mark.parametrize(
    ("old", "new", "limit"),
    [
        ('letter = "C"', 'letter = "T"', "belongs to the heaters"),
        ("max_c = 90.0", "max_c = -1.0", "above min_c"),
        ('sensor_pin = "T2"\n', "", "sensor_pin is missing"),
        ('{ kind = "host", path = "PATH" }', '"chip"', "no sensor in a atmega2560"),
        ("[sensors.Chamber]", "[sensors.hotend]", "heaters.hotend has this one"),
        ('"Generic 3950"', '"Generic 9350"', "the name of a sensor"),
    ],
)
def test_impossible_sensors_are_refused_by_the_machine_file(old, new, limit):
    assert old in SENSORS
    text = SENSORS.replace(old, new)
    with pytest.raises(ConfigError, match=limit):
        config.load_text(shipped_text("i3").replace("[fans.part]", f"{text}[fans.part]"))


def test_letter_of_a_chamber_heater_is_no_sensors_letter():
    heater = """[heaters.room]
kind = "chamber"
pin = "D4"
sensor_pin = "T1"
max_c = 60.0
"""
    text = shipped_text("i3").replace("[fans.part]", f"{heater}{SENSORS}[fans.part]")
    with pytest.raises(ConfigError, match="it belongs to the chamber"):
        config.load_text(text)


@pytest.mark.parametrize(("by", "celsius"), [("mean", 28.0), ("min", 25.0), ("max", 31.0)])
def test_combined_sensor_follows_heaters_and_sensors(by: str, celsius: float):
    both = (
        f'[sensors.both]\nsensor = {{ kind = "combined", of = ["Chamber", "bed"], by = "{by}" }}\n'
    )
    text = shipped_text("i3").replace("[fans.part]", f"{SENSORS}{both}[fans.part]")
    with Scenario(config.load_text(text)) as s:
        assert s.until(lambda: seen(s, "both").celsius is not None, 3)
        assert seen(s, "both").celsius == pytest.approx(celsius, abs=0.5)
        s.board.force_sensor("Chamber", 1.0)
        assert s.until(lambda: seen(s, "both").celsius is None, 5)


@pytest.mark.parametrize("on_fault", ["report", "machine"])
def test_combined_sensor_is_broken_while_its_parts_differ(on_fault: str):
    both = f"""[sensors.both]
sensor = {{ kind = "combined", of = ["Chamber", "bed"], max_deviation_c = 10.0 }}
on_fault = "{on_fault}"
"""
    text = shipped_text("i3").replace("[fans.part]", f"{SENSORS}{both}[fans.part]")
    with Scenario(config.load_text(text)) as s:
        assert s.until(lambda: seen(s, "both").celsius == pytest.approx(28, abs=0.5), 3)
        warms(s, 45.0)
        s.host.expect(r"the sensors of both read (19|20)\.\d C apart, of at most 10 C", 5)
        assert (seen(s, "both").celsius, seen(s, "both").fault) == (None, "apart")
        assert bool(s.printer.state.halted) == (on_fault == "machine")


def test_combined_sensor_of_an_unknown_part_is_refused():
    wrong = '[sensors.both]\nsensor = { kind = "combined", of = ["Chambre"] }\n'
    with pytest.raises(ConfigError) as caught:
        config.load_text(shipped_text("i3").replace("[fans.part]", f"{SENSORS}{wrong}[fans.part]"))
    assert any("Did you mean 'Chamber'" in str(one) for one in caught.value.problems)
