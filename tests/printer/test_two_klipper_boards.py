"""Two boards with Klipper's firmware, whose clocks differ: homing where the switch is on one and
the motor on the other."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.config.test_pins import KLIPPER
from tests.support.klipper_board import dictionary
from tests.support.klipper_printer import STEPS_PER_MM, Board, Port, connected
from tests.support.scenario import Scenario

from passo import config

X_MOTOR = ('"PB0"', '"PB1"', '"!PB2"')
X_SWITCH = ('"^PA8"',)


@dataclass
class Two:
    main: Board
    tool: Board
    link: Port  # to the tool's
    s: Scenario

    def place(self, axis: str) -> float:
        return (self.tool if axis in self.tool.axes else self.main).place(axis)


@pytest.fixture(params=["motor", "switch"])
def two(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """X's motor, or its switch, is on the second board."""
    told = dictionary(chip="stm32", newer=True)
    (tmp_path / "board.dict").write_text(json.dumps(told))
    text = KLIPPER
    for pin in X_MOTOR if request.param == "motor" else X_SWITCH:
        assert text.count(pin) == 1
        marks = pin[1 : pin.index("P")]
        text = text.replace(pin, f'"{marks}tool:{pin[1 + len(marks) :]}')
    text += '\n[boards.tool]\nbase = "klipper"\ndictionary = "board.dict"\n'
    if request.param == "motor":
        main, tool = Board(told, "yz"), Board(told, "x")
        main.hang("x", tool)
    else:
        main, tool = Board(told), Board(told, "")
        tool.hang("x", main)
    at_main = Port(main)
    at_tool = Port(tool, beside=at_main, start_s=77.0, drift=100e-6)
    monkeypatch.setattr("passo.printer.printer.connect", connected(at_main, at_tool))
    with Scenario(config.load_text(text, str(tmp_path / "my.toml"))) as s:
        yield Two(main, tool, at_tool, s)
    assert main.wrong == tool.wrong == []
    assert main.late == tool.late == []


def test_two_klipper_boards_home_and_report_position(two: Two) -> None:
    two.s.host.ok("G28", 60)
    for line in ("G1 X30 Y20 Z5 F6000", "M400"):
        two.s.host.ok(line, 30)
    for axis, mm in {"x": 30, "y": 20, "z": 5}.items():
        assert two.place(axis) == pytest.approx(mm, abs=1.01 / STEPS_PER_MM[axis]), axis
    for board in (two.main, two.tool):
        assert "trsync_start" in [name for name, _ in board.said]


def test_boards_that_lose_each_other_stop_all_motors(two: Two) -> None:
    s = two.s
    s.host.send("G28 X")
    assert s.until(lambda: two.place("x") < 10, 10)
    assert two.link.end
    two.link.end.cut = True
    s.passes(0.1)
    stopped = two.place("x")
    assert 10 - 40 * 0.08 < stopped < 10  # 50 ms of patience and the last news, at 40 mm/s
    s.passes(0.5)
    assert two.place("x") == stopped
    two.link.end.cut = False
    s.host.expect("switch x at .*lost their connection|does not answer stepper_get_position", 10)
    assert 0 in s.printer.rig.job.locked_axes
    s.passes(4)
    s.host.ok("G28 X", 60)
    s.host.ok("G1 X5 F3000")
    s.host.ok("M400", 30)
    assert two.place("x") == pytest.approx(5, abs=1.01 / 80)


@pytest.mark.parametrize("which", ["main", "tool"])
def test_restart_of_one_board_stops_the_other(two: Two, which: str) -> None:
    s = two.s
    s.host.ok("G28", 60)
    s.host.send("G1 X100 Y100 F1200")
    s.passes(2)
    board = two.main if which == "main" else two.tool
    board._act_reset()
    name = "the board" if which == "main" else "board tool"
    s.host.expect(f"^Error:{name} restarted", 2)
    s.host.expect("The printer is ready again", 10)
    for each in (two.main, two.tool):
        assert (each.resets, each.is_shutdown, each.is_config) == (1, 0, 1)
    s.host.ok("G28", 60)
    s.host.ok("G1 X5 F3000")
    s.host.ok("M400", 30)
    assert two.place("x") == pytest.approx(5, abs=1.01 / 80)
