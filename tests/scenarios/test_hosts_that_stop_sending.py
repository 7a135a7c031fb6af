"""A host whose print stands still for long: what stays on, and what it is told when it goes on."""

from collections.abc import Iterator

import pytest
from tests.console.test_protocol import checked
from tests.support.scenario import Host, Scenario

MINUTE_S = 60.0
OPEN = 1.0


@pytest.fixture
def s() -> Iterator[Scenario]:
    with Scenario() as scenario:
        yield scenario


class Printing:
    """Lines with numbers, as hosts send them while they print."""

    def __init__(self, host: Host) -> None:
        self.host = host
        self.number = 0

    def ok(self, text: str, within: float = 300.0) -> list[str]:
        self.number += 1
        return self.host.ok(checked(f"N{self.number} {text}"), within)


def begun(s: Scenario) -> Printing:
    print_ = Printing(s.host)
    for line in ("M109 S200", "G28", "G1 X50 Y50 Z5 F6000", "M400"):
        assert print_.ok(line)[-1] == "ok"
    return print_


def test_motors_hold_the_place_as_long_as_something_is_warm(s):
    print_ = begun(s)
    s.passes(29 * MINUTE_S)
    assert s.printer.outputs.motors.on == {"x", "y", "z", "e"}
    assert print_.ok("G1 X60 E1") == ["ok"]
    assert print_.ok("M400") == ["ok"]
    assert s.positions()["x"] == 60


def test_print_with_lost_position_is_paused_by_first_move(s):
    print_ = begun(s)
    s.passes(31 * MINUTE_S)
    assert s.printer.outputs.motors.on == set()
    assert "echo:Heater hotend off after an idle time" in s.host.heard
    refused = print_.ok("G1 X60 E1")
    assert refused[0].startswith("echo:")
    assert "G28" in refused[0]
    assert refused[1:] == ["// action:pause", "ok"]  # before the host sends the next one
    assert s.positions()["x"] == 50
    # A person at a terminal is told the same, and nothing is paused.
    *told, ok = s.host.ok("G1 X60")
    assert told == [refused[0].replace("X60 E1", "X60")]
    assert ok == "ok"


@pytest.mark.parametrize("line", ["G1 E5", "G28", "X70", "T3"])
def test_each_move_that_is_missing_pauses_the_print(s, line):
    print_ = begun(s)
    print_.ok("M104 S0")
    s.passes(10 * MINUTE_S)
    s.board.force_switch("x", False)
    print_.ok("M302 S170")
    if line == "X70":
        print_.ok("M84")
    assert print_.ok(line)[-2:] == ["// action:pause", "ok"]


def test_command_without_motion_does_not_pause_host(s):
    print_ = begun(s)
    *told, ok = print_.ok("M104 S900")
    assert "// action:pause" not in told
    assert ok == "ok"


def test_failed_heater_keeps_target_and_stays_off(s):
    s.host.ok("M104 S200")
    s.host.ok("M140 S60")
    s.passes(120)
    s.board.force_sensor("hotend", OPEN)
    s.host.expect("Error:Printer halted")
    s.board.force_sensor("hotend", None)
    s.passes(60)
    heaters = s.printer.rig.connection.heaters
    assert (heaters["hotend"].target, heaters["bed"].target) == (200, 0)
    told, _ = s.host.ok("M922")
    assert told.startswith("echo:Printer stopped: heater hotend was switched off: its sensor reads")
    assert told.endswith("then send M999")
    assert "/200.00 " in s.host.ok("M105")[-1]
    s.passes(60)
    assert heaters["hotend"].power == 0
    assert s.board.output_value("hotend") == 0
    s.host.ok("M999")
    s.passes(60)
    heaters = s.printer.rig.connection.heaters
    assert (heaters["hotend"].target, heaters["hotend"].fault) == (0, None)
    assert s.board.output_value("hotend") == 0
