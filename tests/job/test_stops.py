"""Prints that are paused, cancelled or halted: what was planned for later does not happen now."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.support.disturbed_prints import steps
from tests.support.scenario import Host, Scenario

from passo import config


def printing(folder: Path, text: str) -> Scenario:
    (folder / "a.gco").write_text("M302 P1\nG92 X0 Y0 Z0 E0\n" + text)
    scenario = Scenario("i3", card=str(folder))
    scenario.host.ok("M23 a.gco")
    scenario.host.ok("M24")
    return scenario


def test_records_after_what_is_held_wait_for_it(tmp_path: Path) -> None:
    text = "G1 X100 F3000\nM106 S255\nG1 X0\nM106 S51\n"
    with printing(tmp_path, text) as s:
        s.board.trace_output("part")
        s.passes(1.0)
        s.host.send("M25")
        s.passes(3.0)
        assert s.printer.rig.queue.standing
        assert s.board.take_changes("part") == []
        s.host.send("M24")
        s.passes(10.0)
        full = s.printer.rig.connection.full_scale("part")
        shares = [value / full for _, value in s.board.take_changes("part")]
        assert shares == pytest.approx([1.0, 0.2], abs=0.005)


@pytest.mark.parametrize("moment", [0.2 + i * 0.02 for i in range(12)])
def test_a_cancelled_print_sets_no_temperature_any_more(tmp_path: Path, moment: float) -> None:
    text = "".join(f"G1 X{i % 2} F600\nM104 S{200 + i}\n" for i in range(40))
    with printing(tmp_path, text) as s:
        s.passes(0.5 + moment)
        assert s.printer.rig.connection.heaters["hotend"].target >= 200
        s.host.ok("M524")
        s.passes(5.0)
        assert s.printer.rig.connection.heaters["hotend"].target == 0


def test_a_fan_set_at_once_after_a_stop_keeps_its_value() -> None:
    """What was planned of it acts no more."""
    with Scenario("i3") as s:
        for line in ("G92 X0 Y0 Z0", "G1 X100 F600", "M106 S255", "G1 X0"):
            s.host.ok(line)
        s.passes(1.0)
        s.host.ok("M410")
        s.host.ok("M106 S51 F")
        assert s.printer.rig.commands.outputs.fans["part"] == pytest.approx(0.2)
        assert s.until(lambda: s.board.output_value("part") > 0, 5)


def test_a_pause_ends_with_the_board(tmp_path: Path) -> None:
    with printing(tmp_path, "G1 X100 F3000\nG1 X0\n" * 5) as s:
        s.passes(1.0)
        s.host.send("M25")
        s.passes(3.0)
        s.host.send("M112")
        s.passes(1.0)
        s.host.send("M999")
        s.host.expect("ready again", 10.0)
        assert s.printer.state.halted == ""
        s.host.send("M24")  # from the beginning: there is nothing to return to
        s.passes(5.0)
        assert s.printer.state.halted == ""
        assert s.positions()["x"] > 0


def test_a_move_of_a_quarter_of_an_hour_can_be_stopped_and_asked():
    """However low F is, a console waits for nothing."""
    with Scenario("i3") as s:
        s.host.ok("G28", 60)
        s.host.ok("G1 X1 F0.06")
        s.passes(30)
        assert s.printer.rig.queue.ahead_s > 900
        assert "Real: X:0.025" in s.host.ok("M114 D", 1)[1]
        s.host.ok("M410", 1)
        s.passes(1)
        assert s.printer.rig.queue.standing
        s.host.ok("G1 X2 F0.06")
        s.passes(2)
        s.host.ok("M112", 1)
        assert s.printer.state.halted == "emergency stop by M112"


def test_a_further_axis_that_is_moved_in_a_pause_comes_back(tmp_path: Path) -> None:
    text = config.shipped_text("i3").replace("[steppers.e]", "[steppers.u]")
    text = text.replace("[extruders.e]", "[axes.u]\nmin_mm = -100.0\nhome_mm = 0.0\nmax_mm = 100.0")
    turns = [f"G1 X{50 + 40 * (i % 2)} U{i} F1500" for i in range(10)]
    program = ["G28", "G92 U0", "G1 X50 Y50 Z5 F6000", *turns, "M400"]
    (tmp_path / "a.g").write_text("\n".join(program) + "\n")

    def net(moved_mm: float) -> dict[str, int]:
        with Scenario(config.load_text(text), card=str(tmp_path)) as s:
            s.host.ok("M32 a.g")
            assert s.until(
                lambda: s.printer.rig.job.history.line_at(s.printer.rig.queue.now) >= 8, 300
            )
            s.host.ok("M25")
            for line in ("G91", f"G1 U{moved_mm:g} F300", "M24"):
                s.host.ok(line)
            s.host.expect("Done printing", 300)
            return steps(s)

    assert net(20) == net(0)


def test_print_stays_paused_if_arms_cannot_return(tmp_path: Path) -> None:
    """Between two places of a round work space the straight way may lead through its hole."""
    limits = "min_mm = 0.0\nmax_mm = 200.0"
    text = config.shipped_text("scara").replace(limits, "min_mm = -200.0\nmax_mm = 400.0")
    way = "\n".join(f"G1 X{-40 - i % 2} F60" for i in range(20))
    (tmp_path / "a.g").write_text(f"G92 X-40 Y-40 Z5\n{way}\n")
    with Scenario(config.load_text(text), card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.passes(5)
        s.host.ok("M25")
        for line in ("G90", "G1 X-120 Y40 F6000", "G1 X240 Y-40", "M400"):
            assert s.host.ok(line, 60)[-1] == "ok"
        s.host.ok("M24")
        s.host.expect("Print of a.g stays paused: motor a would go to -60", 20)
        assert s.printer.rig.job.machine_position[:2] == [240, -40]
        for line in ("G1 X-120 Y40 F6000", "G1 X-41 Y-40", "M24"):
            assert s.host.ok(line, 60)[-1] == "ok"
        s.host.expect("^Done printing file$", 60)
        assert s.printer.rig.job.machine_position[:2] == [-41, -40]


@pytest.mark.parametrize("code", ["M25", "M524"])
def test_a_print_that_waits_for_its_turn_is_ended_by_a_halt(tmp_path: Path, code: str) -> None:
    """There is nothing to brake on a board that has stopped."""
    (tmp_path / "a.g").write_text("G1 X1\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        homing = Host(s)
        homing.send("G28", "M32 a.g")
        s.passes(3)
        s.host.send("M350")
        s.host.send("M112")
        s.host.send(code, "M27")
        s.passes(2)
        assert not [line for line in s.host.heard if "fault of the program" in line]
        assert s.host.heard.count("ok") == 4
        assert not s.printer.state.busy()
        s.host.send("M999")
        s.host.expect("ready again", 5)
        s.host.ok("M32 a.g", 10)


def test_print_can_be_paused_and_resumed_at_its_start(tmp_path: Path) -> None:
    with printing(tmp_path, "G1 X10 F3000\n") as s:
        s.host.send("M25", "M24")
        s.host.expect("Done printing file", 20)
        assert s.positions()["x"] == 20 + 10  # from where it stood
        assert not s.printer.rig.job.stops.suspended
        s.host.send("M23 a.gco", "M24", "M25", "M24", "M25")
        s.passes(5)
        assert s.host.ok("M27")[0].startswith("SD printing")
        s.host.ok("M24")
        s.host.expect("Done printing file", 20)
        assert not s.printer.rig.job.stops.suspended
