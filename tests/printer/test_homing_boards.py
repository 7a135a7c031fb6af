"""Homing where switches and motors are on different boards, whose links take their time."""

from functools import partial

import pytest
from tests.support.scenario import Scenario

from passo.config.load import load_text, shipped_text
from passo.printer.setup.connections import connect_simulated
from passo.simulator import Cable

TOOL = '\n[boards.tool]\nbase = "ramps"\ndrift_ppm = 100.0\nstart_s = 77.0\n'
SLOW = Cable(5e-3, 1e-3)


def scenario(monkeypatch, machine, *moved, cable=SLOW):
    """`moved` are the sockets and pins that are on the second board."""
    text = shipped_text(machine)
    for name in moved:
        assert f'"{name}"' in text
        marks = name[: len(name) - len(name.lstrip("^!"))]
        text = text.replace(f'"{name}"', f'"{marks}tool:{name.lstrip("^!")}"')
    monkeypatch.setattr("passo.printer.printer.connect", partial(connect_simulated, cable=cable))
    return Scenario(load_text(text + TOOL))


@pytest.mark.parametrize(
    ("machine", "moved", "step"),
    [
        ("i3", ["X"], 1 / 80),
        ("i3", ["^X_MIN", "Z"], 1 / 80),
        ("corexy", ["Y"], 1 / 40),  # X and Y both turn both motors, one on each board
        ("corexy", ["X", "Y"], 1 / 40),
        ("corexy", ["Z", "E1"], 1 / 40),  # both motors of Z
        ("delta", ["Z"], 1 / 87),
        ("scara", ["X"], 1 / 103),
    ],
)
def test_the_place_counts_from_the_switch_and_not_from_the_stop(monkeypatch, machine, moved, step):
    with scenario(monkeypatch, machine, *moved) as s:
        assert s.host.ok("G28", 60)[-1] == "ok"
        x, y, z = there = s.printer.rig.job.machine_position[:3]
        if machine in ("i3", "corexy"):
            there = x, y, z = 30.0, 20.0, 5.0
        s.host.ok(f"G1 X{x} Y{y} Z{z} F6000", 60)
        s.host.ok("M400", 60)
        at = s.positions()
        wanted = s.machine.geometry.inverse(there)
        for name, goal in zip(s.machine.geometry.actuators, wanted, strict=True):
            assert at[name] == pytest.approx(goal, abs=1.01 * step), name


def stops(monkeypatch, cable):
    """How far X, at 40 mm/s, runs on beyond its switch on another board before it stops, mm."""
    with scenario(monkeypatch, "i3", "X", cable=cable) as s:
        found = []
        s.host.send("G28 X")
        assert s.until(lambda: found.append(s.positions()["x"]) or len(found) > 300, 10)
        return -min(found)


def test_motor_on_other_board_stops_after_link_delay(monkeypatch):
    at_once = stops(monkeypatch, Cable(1e-4, 0.0))
    late = stops(monkeypatch, Cable(5e-3, 0.0))
    # 5 ms from the switch's board, 5 ms to the motor's.
    assert at_once <= 40 * (0.0002 + 0.001) + 1 / 80
    assert late == pytest.approx(at_once + 40 * 0.0098, abs=2 / 80)


@pytest.mark.parametrize("moved", [["X"], ["^X_MIN"]])
def test_boards_that_lose_each_other_stop_all_motors(monkeypatch, moved):
    with scenario(monkeypatch, "i3", *moved) as s:
        s.host.send("G28 X")
        assert s.until(lambda: s.positions()["x"] < 10, 10)
        s.printer.board.cut_cable("tool")
        s.passes(0.1)
        stopped = s.positions()["x"]
        # 50 ms of patience and the last news, at 40 mm/s.
        assert 10 - 40 * 0.08 < stopped < 10
        s.passes(0.5)
        assert s.positions()["x"] == stopped
        s.printer.board.cut_cable("tool", False)
        s.host.expect(
            "switch x at .*lost their connection|does not answer stepper_get_position", 10
        )
        assert 0 in s.printer.rig.job.locked_axes
        # All is well again, once the time has passed in which the board was asked in vain.
        s.passes(4)
        assert s.host.ok("G28 X", 60)[-1] == "ok"
        s.host.ok("G1 X5 F3000", 60)
        s.host.ok("M400", 60)
        assert s.positions()["x"] == pytest.approx(5, abs=1.01 / 80)
