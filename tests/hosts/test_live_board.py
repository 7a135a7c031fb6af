"""A board on a cable, in real time: the thread of the link does not depend on the interpreter."""

from __future__ import annotations

import asyncio
import ctypes
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.console.scenario import Host, Scenario
from tests.hosts.cable import Cable
from tests.hosts.served import free_port

from passo import config
from passo._core import Cause, make_frame
from passo.board.connection import Connection
from passo.board.ports import LinkLostError, LivePort
from passo.cli.main import main
from passo.config.machine import MachineConfig
from passo.errors import MachineError
from passo.printer.wiring import board_description, connect

MACHINE = config.load("i3")
RUNS_FIRMWARE = MACHINE.model_copy(
    update={"board": MACHINE.board.model_copy(update={"firmware": "passo"})}
)
STALL_US = 500_000


def stall() -> None:
    """Nothing in Python runs for half a second: whoever sleeps here holds the interpreter lock."""
    ctypes.PyDLL(None).usleep(STALL_US)


def on(link: str, port: str) -> MachineConfig:
    """The machine with its board at such a place."""
    board = MACHINE.board.model_copy(update={"link": link, "port": port})
    return MACHINE.model_copy(update={"board": board})


@pytest.fixture(params=["virtual", "passo"])
def cable(request: pytest.FixtureRequest) -> Iterator[Cable]:
    """A model of a board, or one that runs the firmware."""
    board = MACHINE.board.model_copy(update={"firmware": request.param})
    cable = Cable(MACHINE.model_copy(update={"board": board}))
    yield cable
    cable.close()


def test_a_stall_of_the_interpreter_delays_no_step(cable: Cable) -> None:
    with Scenario(on("serial", cable.path), loop=asyncio.new_event_loop()) as scenario:
        host = scenario.host
        host.ok("G92 X0 Y0 Z0")
        host.ok("M302 P1")
        for i in range(40):
            host.send(f"G1 X{10 if i % 2 else 0} Y{i / 4} E{i / 20} F3000")
        host.send("M400")
        scenario.passes(0.8)
        stall()
        scenario.passes(0.7)
        stall()
        assert not scenario.printer.drive.standing
        scenario.until(lambda: scenario.printer.drive.standing, 20.0)
        assert scenario.printer.halted == ""
    cable.cut()
    assert cable.board.device.fault == ""
    steps = {s.name: cable.board.net_steps(s.name) for s in cable.board.board.steppers}
    assert steps == {"x": 800, "y": 780, "z": 0, "e": round(1.95 * 95.5)}


def test_a_stall_of_the_interpreter_is_none_of_the_links(cable: Cable) -> None:
    """A plan for two seconds is on the way: the thread sends it in time."""
    with Scenario(on("serial", cable.path), loop=asyncio.new_event_loop()) as scenario:
        host, link = scenario.host, scenario.printer.connection.main.link
        host.ok("G92 X0")
        host.send("G1 X40 F600", "G1 X60")
        scenario.passes(1.0)
        stall()
        scenario.passes(0.3)
        assert link.late_frames[Cause.PLAN] == 0
        told = [x for x in Host(scenario).ok("M122") if x.startswith("Link: least slack ")]
        assert re.search(r"slack \d+ ms; late frames: \d+ of \d+[ ;]", told[0])


def test_a_program_that_stands_still_is_to_blame_for_late_commands(tmp_path: Path) -> None:
    """The whole program is stopped for 0.2 s: the board brakes, and the moves go on."""
    cable = Cable(RUNS_FIRMWARE)
    file = tmp_path / "mine.toml"
    text = Path(config.__file__).with_name("machines").joinpath("i3.toml").read_text()
    link = f'base = "ramps"\nlink = "serial"\nport = "{cable.path}"'
    file.write_text(text.replace('base = "ramps"', link))
    place = f"127.0.0.1:{free_port()}"
    words = [sys.executable, "-m", "passo", "serve", "--machine", str(file), "--tcp", place]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as program:
        assert program.stderr is not None
        assert program.stderr.readline().startswith("Serving")
        host, _, port = place.partition(":")
        with socket.create_connection((host, int(port)), timeout=30.0) as console:
            lines = console.makefile("r", encoding="ascii", newline="\n")
            moves = [f"G1 X{10 if i % 2 else 0} Y{i / 4} F3000" for i in range(20)]
            text = "\n".join(["G92 X0 Y0 Z0", "M118 begun", *moves, "M400", "M118 ended", ""])
            console.sendall(text.encode())
            heard: list[str] = []

            def until(part: str) -> None:
                while not heard or part not in heard[-1]:
                    heard.append(lines.readline())
                    assert heard[-1], heard

            until("begun")
            while cable.look(lambda: cable.board.steps("x")) < 1600:
                time.sleep(0.01)
            program.send_signal(signal.SIGSTOP)
            time.sleep(0.2)
            program.send_signal(signal.SIGCONT)
            until("ended")
        program.terminate()
    told = [x for x in heard if "commands reached the board" in x]
    assert any("the computer did not let Passo run for 0." in x for x in told), told
    cable.cut()
    assert cable.board.device.fault == ""
    assert {n: cable.board.net_steps(n) for n in "xy"} == {"x": 800, "y": 380}
    cable.close()


def test_a_board_that_breaks_its_own_dictionary_is_named() -> None:
    ours, board = socket.socketpair()
    with board:
        description = board_description(MACHINE)
        connection = Connection(description, LivePort(lambda: ours.detach()))
        connection.link.set_dictionary([], [(5, "shutdown reason=%.*s")], 0)
        board.sendall(make_frame(bytes((5, 3)) + b"hot", 1))
        sentence = "connection to the board was ended: its report shutdown cannot be used"
        with pytest.raises(LinkLostError, match=sentence):
            connection.run(connection.now + 5 * MACHINE.board.clock_hz)
        connection.close()


def test_a_stall_at_the_end_of_a_few_long_moves_costs_nothing(cable: Cable) -> None:
    """The host's last move comes when the plan is about to run dry, and then nobody looks."""
    with Scenario(on("serial", cable.path), loop=asyncio.new_event_loop()) as scenario:
        host, drive = scenario.host, scenario.printer.drive
        host.ok("G92 X0")
        host.send("G1 X10 F600", "G1 X20")
        scenario.passes(0.5)
        for x in (24, 28):
            scenario.until(lambda: drive.ahead_s < 0.45, 10.0)
            host.send(f"G1 X{x}")
            scenario.passes(0.03)
            stall()
        host.send("M400", "M118 done")
        host.expect("done", 10.0)
        assert scenario.printer.halted == ""
    cable.cut()
    assert cable.board.device.fault == ""
    assert cable.board.position("x") == pytest.approx(20.0 + 28.0)


def test_a_stall_at_the_start_of_a_move_costs_nothing(cable: Cable) -> None:
    with Scenario(on("serial", cable.path), loop=asyncio.new_event_loop()) as scenario:
        host = scenario.host
        host.ok("G92 X0")
        host.send("G1 X5 F3000")
        scenario.passes(0.06)
        stall()
        host.send("M400", "M118 done")
        host.expect("done", 10.0)
        assert scenario.printer.halted == ""
    cable.cut()
    assert cable.board.device.fault == ""
    assert cable.board.position("x") == pytest.approx(25.0)


def test_a_print_goes_on_when_the_cable_is_back() -> None:
    cable = Cable(RUNS_FIRMWARE)
    with Scenario(on("serial", cable.path), loop=asyncio.new_event_loop()) as scenario:
        host = scenario.host
        host.ok("G92 X0 Y0 Z0")
        host.ok("M302 P1")
        host.send("M104 S50")
        other = Host(scenario)
        for i in range(40):
            host.send(f"G1 X{10 if i % 2 else 0} Y{i / 4} E{i / 20} F3000")
        for seconds in (0.3, 1.0):
            scenario.passes(1.2)
            cable.unplug()
            scenario.passes(seconds)
            assert "connection to the board has ended" in other.ok("M114 R")[0]
            cable.plug()
            host.expect("stands where it was told to stop", 20.0)
        host.send("M400", "M118 done")
        host.expect("done", 30.0)
        assert scenario.printer.halted == ""
    cable.cut()
    assert cable.board.device.fault == ""
    steps = {s.name: cable.board.net_steps(s.name) for s in cable.board.board.steppers}
    assert steps == {"x": 800, "y": 780, "z": 0, "e": round(1.95 * 95.5)}
    cable.close()


def test_another_host_goes_on_with_the_print_without_homing(tmp_path: Path) -> None:
    """The host is killed in mid-print; the board stops by itself and knows where."""
    cable = Cable(RUNS_FIRMWARE)
    moves = [f"G1 X{60 if i % 2 else 40} Y{40 + i / 4} F3000" for i in range(32)]
    card = tmp_path / "card"
    card.mkdir()
    (card / "a.g").write_text("\n".join(["M302 P1", "G28", "G1 X40 Y40 Z1 F6000", *moves]) + "\n")
    places = {"card": str(card), "state": str(tmp_path / "state")}
    machine = on("serial", cable.path)
    with Scenario(machine, **places, loop=asyncio.new_event_loop()) as scenario:
        scenario.host.ok("M32 a.g")
        scenario.until(lambda: cable.look(lambda: cable.board.position("y")) > 42, 60.0)
        cable.unplug()
        scenario.passes(0.5)
    cable.plug()
    stopped = cable.look(lambda: cable.board.position("x"))
    with Scenario(machine, **places, loop=asyncio.new_event_loop()) as scenario:
        assert scenario.printer.connection.adopted
        assert "from where the board has stopped" in scenario.printer.greeting()
        assert cable.look(lambda: cable.board.position("x")) == stopped
        scenario.host.send("M1000")
        scenario.host.expect("Printing a.g from line", 20.0)
        scenario.host.expect("Done printing", 90.0)
        assert scenario.printer.halted == ""
    cable.cut()
    assert cable.board.device.fault == ""
    assert cable.board.position("x") == pytest.approx(60.0, abs=0.02)
    assert cable.board.position("y") == pytest.approx(40 + 31 / 4, abs=0.02)
    cable.close()


def test_who_does_not_want_to_wait_for_the_board_stops_the_printer() -> None:
    cable = Cable(RUNS_FIRMWARE)
    with Scenario(on("serial", cable.path), loop=asyncio.new_event_loop()) as scenario:
        host = scenario.host
        host.ok("G92 X0 Y0 Z0")
        host.send("G1 X50 F600")
        scenario.passes(1.0)
        cable.unplug()
        host.expect("The machine waits", 5.0)
        host.send("M112")
        host.expect("Printer halted", 5.0)
        cable.plug()
        host.send("M999")
        host.expect("ready again", 20.0)
    cable.close()


def test_a_cut_cable_halts_the_printer_of_a_board_that_cannot_stop_by_itself() -> None:
    cable = Cable(MACHINE)
    with Scenario(on("serial", cable.path), loop=asyncio.new_event_loop()) as scenario:
        scenario.host.ok("G92 X0 Y0 Z0")
        cable.cut()
        scenario.host.expect("connection to the board has ended", 5.0)
        assert "connection to the board" in scenario.printer.halted
    cable.close()


def test_an_emergency_stop_is_over_after_m999(cable: Cable) -> None:
    with Scenario(on("serial", cable.path), loop=asyncio.new_event_loop()) as scenario:
        host = scenario.host
        host.ok("G92 X0")
        host.send("G1 X50 F600")
        scenario.passes(1.0)
        host.send("M112")
        host.expect("^Error:", 2.0)
        scenario.until(lambda: scenario.printer.halted != "", 2.0)
        host.send("M999")
        host.expect("ready again", 10.0)
        before = cable.look(lambda: cable.board.position("x"))
        host.ok("G92 X0")
        host.ok("G1 X2 F600")
        host.ok("M400")
        assert scenario.printer.halted == ""
    cable.cut()
    assert cable.board.device.fault == ""
    assert cable.board.position("x") == pytest.approx(before + 2.0)


def test_heaters_are_off_when_the_printer_ends(cable: Cable) -> None:
    with Scenario(on("serial", cable.path), loop=asyncio.new_event_loop()) as scenario:
        scenario.host.ok("M104 S200")
        scenario.passes(2.0)
        assert scenario.printer.connection.heaters["hotend"].power > 0.5
    cable.cut()
    assert cable.board.device.fault == ""
    assert cable.board.output_value("hotend") == 0
    assert cable.board.temperature("hotend") > 22.0


def test_a_board_keeps_its_own_time(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "mine.toml"
    text = Path(config.__file__).with_name("machines").joinpath("i3.toml").read_text()
    link = 'base = "ramps"\nlink = "serial"\nport = "/dev/ttyUSB7"'
    file.write_text(text.replace('base = "ramps"', link))
    assert main(["serve", "--machine", str(file), "--clock", "fast"]) == 2
    assert "/dev/ttyUSB7 keeps its own time: leave --clock out" in capsys.readouterr().err
    assert main(["serve", "--machine", str(file)]) == 5
    assert "the board cannot be reached at /dev/ttyUSB7" in capsys.readouterr().err


def test_a_board_that_is_not_there_is_named() -> None:
    with pytest.raises(MachineError, match="cannot be reached at /dev/nothing: No such file"):
        connect(on("serial", "/dev/nothing"))
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    with pytest.raises(MachineError, match=f"127.0.0.1:{port}: Connection refused"):
        connect(on("tcp", f"127.0.0.1:{port}"))
