"""A pause in which nobody comes: the nozzle goes off, and warms up before all goes on."""

from __future__ import annotations

import pytest
from tests.support.scenario import Host, Scenario

from passo import config

OFF_S, LONG_S = 60, 75
LINES = [f"G1 X{30 + i % 2 * 40} E1 F1200" for i in range(10)]


def targets(s: Scenario) -> dict[str, float]:
    return {name: heater.target for name, heater in s.printer.rig.connection.heaters.items()}


@pytest.fixture
def s(tmp_path):
    (tmp_path / "a.g").write_text("\n".join(["M83", *LINES]))
    text = f"{config.shipped_text('i3')}\n[idle]\nheaters_off_s = {OFF_S}.0\n"
    with Scenario(config.load_text(text), card=str(tmp_path)) as scenario:
        for line in ("G92 X30 Y0 Z0 E0", "M140 S40", "M109 S180"):
            scenario.host.ok(line, 300)
        yield scenario


def pause(s: Scenario, what: str) -> None:
    if what == "M25":
        s.host.ok("M32 a.g")
        s.passes(3)
        s.host.ok("M25")
    else:
        s.host.send("M83", *LINES[:3], what, *LINES[3:])
        s.passes(10)


@pytest.mark.parametrize(
    ("what", "on"), [("M25", "M24"), ("M600", "M108"), ("M601", "M602"), ("M0", "M108")]
)
def test_a_long_pause_cools_the_nozzle_and_warms_it_again(s, what, on):
    start = s.positions()["e"]
    pause(s, what)
    s.passes(OFF_S - 20)
    assert targets(s) == {"hotend": 180, "bed": 40}
    s.passes(LONG_S - OFF_S + 20)
    assert targets(s) == {"hotend": 0, "bed": 40}
    s.host.expect("Heater hotend off in a long pause; it warms up before the print resumes")
    s.passes(60)
    at = s.positions()
    other = Host(s)
    other.send(on)
    s.passes(5)
    assert targets(s) == {"hotend": 180, "bed": 40}
    assert s.positions() == at
    assert s.until(lambda: s.positions()["e"] - start > len(LINES) - 0.02, 300)
    assert not [x for x in s.host.heard if "cold extrusion" in x]
    assert s.printer.rig.connection.heaters["hotend"].celsius > 175


@pytest.mark.parametrize(
    ("command", "celsius"), [("M104 S0", 0), ("M104 S190", 190), ("M410", 0), ("M524", 0)]
)
def test_target_set_in_pause_holds(s, command, celsius):
    pause(s, "M25")
    s.passes(LONG_S)
    s.host.ok(command)
    s.host.ok("M24")
    s.passes(30)
    assert targets(s)["hotend"] == celsius


def test_printer_does_not_reheat_for_a_host_that_left(s):
    other = Host(s)
    other.send("M0")
    s.passes(LONG_S)
    other.session.close()
    s.passes(60)
    assert targets(s)["hotend"] == 0


IDLE = """
[idle]
heaters_off_s = 60.0
motors_off_s = 60.0
[delayed_gcode.rest]
when_idle = true
gcode = '''
G91
G1 X5 F600
G90
M117 rests'''
"""


@pytest.fixture
def idle():
    text = config.shipped_text("i3") + IDLE
    with Scenario(config.load_text(text)) as scenario:
        for line in ("G92 X30 Y0 Z0 E0", "M140 S40", "G1 X40 F6000", "M400"):
            scenario.host.ok(line, 300)
        yield scenario


def test_gcode_of_an_idle_printer_runs_once_until_it_moves(idle):
    start = idle.positions()["x"]
    idle.passes(50)
    assert idle.positions()["x"] == pytest.approx(start)
    idle.passes(20)
    assert idle.positions()["x"] == pytest.approx(start + 5)
    assert targets(idle)["bed"] == 0
    idle.passes(300)
    assert idle.positions()["x"] == pytest.approx(start + 5)
    idle.host.ok("G92 X0", 60)
    idle.passes(70)
    assert idle.positions()["x"] == pytest.approx(start + 10)


def test_set_idle_timeout_counts_until_the_restart(idle):
    start = idle.positions()["x"]
    idle.host.ok("SET_IDLE_TIMEOUT TIMEOUT=200", 60)
    idle.passes(150)
    assert targets(idle)["bed"] == 40
    idle.passes(60)
    assert targets(idle)["bed"] == 0
    assert idle.positions()["x"] == pytest.approx(start + 5)
    idle.host.send("SET_IDLE_TIMEOUT TIMEOUT=0").expect("TIMEOUT is 0: expected more than 0")
