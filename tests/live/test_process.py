"""Passo as a process that stands still, is killed, or is told a wrong place of its board."""

from __future__ import annotations

import asyncio
import signal
import time
from pathlib import Path

import pytest
from tests.live.cable import Cable
from tests.live.prints import RUNS_FIRMWARE, Program, machine_file, net_steps, on, wait_for
from tests.support.scenario import Scenario

from passo.cli.main import main


def test_stalled_program_is_named_for_late_commands(tmp_path: Path) -> None:
    """The whole program is stopped for 0.2 s: the board brakes, and the moves go on."""
    cable = Cable(RUNS_FIRMWARE)
    with Program(machine_file(tmp_path, cable.path)) as program:
        moves = [f"G1 X{10 if i % 2 else 0} Y{i / 4} F3000" for i in range(12)]
        program.send("G92 X0 Y0 Z0", "M118 begun", *moves, "M400", "M118 ended")
        program.until("begun")
        wait_for(cable, lambda: cable.board.steps("x") >= 1600)
        program.process.send_signal(signal.SIGSTOP)
        time.sleep(0.2)
        program.process.send_signal(signal.SIGCONT)
        program.until("ended")
    told = [x for x in program.heard if "commands reached the board" in x]
    assert any("the computer did not let Passo run for 0." in x for x in told), told
    assert net_steps([cable]) == {"x": 800, "y": 220, "z": 0, "e": 0}
    cable.close()


def test_next_host_resumes_print_of_killed_one(tmp_path: Path) -> None:
    """The board stops by itself in mid-print and knows where: nothing is homed again."""
    cable = Cable(RUNS_FIRMWARE)
    moves = [f"G1 X{60 if i % 2 else 40} Y{40 + i / 4} F3000" for i in range(16)]
    card = tmp_path / "card"
    card.mkdir()
    begin = ["M302 P1", "G92 X0 Y0 Z0", "G1 X40 Y40 Z1 F6000"]
    (card / "a.g").write_text("\n".join([*begin, *moves]) + "\n")
    places = {"card": str(card), "state": str(tmp_path / "state")}
    more = ("--sd", places["card"], "--state", places["state"])
    start = cable.look(lambda: (cable.board.position("x"), cable.board.position("y")))
    with Program(machine_file(tmp_path, cable.path), *more) as program:
        program.send("M32 a.g")
        wait_for(cable, lambda: cable.board.position("y") > start[1] + 41)
        program.process.send_signal(signal.SIGKILL)
        assert program.process.wait() == -signal.SIGKILL
    moving = cable.look(lambda: cable.board.position("x"))
    time.sleep(0.5)
    stopped = cable.look(lambda: cable.board.position("x"))
    assert stopped != moving  # it went on to the end of what it had, and braked
    time.sleep(0.2)
    assert cable.look(lambda: cable.board.position("x")) == stopped
    with Scenario(on("serial", cable.path), **places, loop=asyncio.new_event_loop()) as scenario:
        assert scenario.printer.rig.connection.adopted
        assert "from where the board has stopped" in scenario.printer.state.greeting()
        assert cable.look(lambda: cable.board.position("x")) == stopped
        scenario.host.send("M1000")
        scenario.host.expect("Printing a.g from line", 20.0)
        scenario.host.expect("Done printing", 90.0)
        assert scenario.printer.state.halted == ""
    cable.cut()
    assert cable.board.device.fault == ""
    assert cable.board.position("x") == pytest.approx(start[0] + 60, abs=0.02)
    assert cable.board.position("y") == pytest.approx(start[1] + 40 + 15 / 4, abs=0.02)
    cable.close()


def test_a_board_keeps_its_own_time(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = str(machine_file(tmp_path, "/dev/ttyUSB7"))
    assert main(["serve", "--machine", file, "--clock", "fast"]) == 2
    assert "/dev/ttyUSB7 keeps its own time: leave --clock out" in capsys.readouterr().err
    assert main(["serve", "--machine", file]) == 5
    assert "the board cannot be reached at /dev/ttyUSB7" in capsys.readouterr().err
