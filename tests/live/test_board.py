"""A board on a cable, in real time: the thread of the link does not depend on the interpreter."""

from __future__ import annotations

import asyncio
import re
import socket
from collections.abc import Iterator

import pytest
from tests.live.cable import Cable, TcpCable
from tests.live.prints import (
    MACHINE,
    RUNS_FIRMWARE,
    ZIGZAG_STEPS,
    ends,
    net_steps,
    on,
    stall,
    zigzag,
)
from tests.support.scenario import Host, Scenario

from passo._core import Cause, make_frame
from passo.board.connection import Connection
from passo.board.ports import LinkLostError, LivePort
from passo.config.machine import MachineConfig
from passo.errors import MachineError
from passo.printer.setup.boards import board_description
from passo.printer.setup.connections import connect


@pytest.fixture(params=["virtual", "passo"])
def cable(request: pytest.FixtureRequest) -> Iterator[Cable]:
    """A model of a board, or one that runs the firmware."""
    board = MACHINE.board.model_copy(update={"firmware": request.param})
    cable = Cable(MACHINE.model_copy(update={"board": board}))
    yield cable
    cable.close()


@pytest.mark.parametrize(
    ("made", "link", "machine"),
    [
        (Cable, "serial", MACHINE),
        (Cable, "serial", RUNS_FIRMWARE),
        (TcpCable, "tcp", RUNS_FIRMWARE),
    ],
)
def test_a_stall_of_the_interpreter_delays_no_step(
    made: type[Cable], link: str, machine: MachineConfig
) -> None:
    cable = made(machine)
    with Scenario(on(link, cable.path, cable.runs), loop=asyncio.new_event_loop()) as scenario:
        zigzag(scenario.host)
        scenario.passes(0.8)
        stall()
        scenario.passes(0.7)
        stall()
        assert not scenario.printer.rig.queue.standing
        scenario.until(lambda: scenario.printer.rig.queue.standing, 20.0)
        ends(scenario)
        assert not [line for line in scenario.host.heard if "The machine waits" in line]
    assert net_steps([cable]) == ZIGZAG_STEPS
    cable.close()


def test_stall_of_the_interpreter_does_not_stall_links(cable: Cable) -> None:
    """A plan for two seconds is on the way: the thread sends it in time."""
    with Scenario(on("serial", cable.path, cable.runs), loop=asyncio.new_event_loop()) as scenario:
        host, link = scenario.host, scenario.printer.rig.connection.main.link
        host.ok("G92 X0")
        host.send("G1 X40 F600", "G1 X60")
        scenario.passes(1.0)
        stall()
        scenario.passes(0.3)
        assert link.late_frames[Cause.PLAN] == 0
        told = [x for x in Host(scenario).ok("M122") if x.startswith("Link: least slack ")]
        assert re.search(r"slack \d+ ms; late frames: \d+ of \d+[ ;]", told[0])


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
    with Scenario(on("serial", cable.path, cable.runs), loop=asyncio.new_event_loop()) as scenario:
        host, queue = scenario.host, scenario.printer.rig.queue
        host.ok("G92 X0")
        host.send("G1 X10 F600", "G1 X20")
        scenario.passes(0.5)
        for x in (24, 28):
            scenario.until(lambda: queue.ahead_s < 0.45, 10.0)
            host.send(f"G1 X{x}")
            scenario.passes(0.03)
            stall()
        ends(scenario)
    assert net_steps([cable])["x"] == 28 * 80


def test_a_stall_at_the_start_of_a_move_costs_nothing(cable: Cable) -> None:
    with Scenario(on("serial", cable.path, cable.runs), loop=asyncio.new_event_loop()) as scenario:
        host = scenario.host
        host.ok("G92 X0")
        host.send("G1 X5 F3000")
        scenario.passes(0.06)
        stall()
        ends(scenario)
    assert net_steps([cable])["x"] == 5 * 80


def test_a_print_resumes_when_the_cable_is_back() -> None:
    cable = Cable(RUNS_FIRMWARE)
    with Scenario(on("serial", cable.path, cable.runs), loop=asyncio.new_event_loop()) as scenario:
        host, other = scenario.host, Host(scenario)
        host.send("M104 S50")
        zigzag(host)
        for seconds in (0.3, 1.0):
            scenario.passes(1.2)
            cable.unplug()
            scenario.passes(seconds)
            assert "connection to the board has ended" in other.ok("M114 R")[0]
            cable.plug()
            host.expect("at the position where it stopped", 20.0)
        ends(scenario, 30.0)
    assert net_steps([cable]) == ZIGZAG_STEPS
    cable.close()


def test_board_reset_in_mid_move_is_configured_again(cable: Cable) -> None:
    with Scenario(on("serial", cable.path, cable.runs), loop=asyncio.new_event_loop()) as scenario:
        host = scenario.host
        host.send("M104 S50")
        zigzag(host)
        scenario.passes(1.2)
        scenario.printer.rig.connection.main.command("reset")
        host.expect("^Error:the board restarted", 3.0)
        host.expect("The printer is ready again", 10.0)
        assert scenario.printer.rig.connection.heaters["hotend"].target == 50.0
        stood = cable.look(lambda: cable.board.net_steps("x"))
        host.ok("G92 X0 Y0 Z0")
        host.send("G1 X5 F3000")
        ends(scenario)
    assert net_steps([cable])["x"] - stood == 5 * 80


def test_m112_while_waiting_for_board_halts() -> None:
    cable = Cable(RUNS_FIRMWARE)
    with Scenario(on("serial", cable.path, cable.runs), loop=asyncio.new_event_loop()) as scenario:
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


def test_emergency_stop_reaches_board_when_cable_is_back() -> None:
    cable = Cable(RUNS_FIRMWARE)
    with Scenario(on("serial", cable.path, cable.runs), loop=asyncio.new_event_loop()) as scenario:
        host = scenario.host
        cable.unplug()
        host.expect("The machine waits", 5.0)
        host.ok("M112")
        host.expect("has not reached the board, which may heat for up to a minute", 5.0)
        assert cable.look(lambda: cable.board.device.fault) == ""
        cable.plug()
        host.expect("Emergency stop confirmed by all boards", 5.0)
        assert cable.look(lambda: cable.board.device.fault) == "Command request"
        host.ok("M999")
        assert scenario.printer.state.halted == ""
    cable.close()


def test_cut_cable_halts_board_without_survive() -> None:
    cable = Cable(MACHINE)
    with Scenario(on("serial", cable.path, cable.runs), loop=asyncio.new_event_loop()) as scenario:
        scenario.host.ok("G92 X0 Y0 Z0")
        cable.cut()
        scenario.host.expect("connection to the board has ended", 5.0)
        assert "connection to the board" in scenario.printer.state.halted
    cable.close()


def test_an_emergency_stop_is_over_after_m999(cable: Cable) -> None:
    with Scenario(on("serial", cable.path, cable.runs), loop=asyncio.new_event_loop()) as scenario:
        host = scenario.host
        host.ok("G92 X0")
        host.send("G1 X50 F600")
        scenario.passes(1.0)
        host.send("M112")
        host.expect("^Error:", 2.0)
        scenario.until(lambda: scenario.printer.state.halted != "", 2.0)
        host.send("M999")
        host.expect("ready again", 10.0)
        before = cable.look(lambda: cable.board.position("x"))
        host.ok("G92 X0")
        host.ok("G1 X2 F600")
        host.ok("M400")
        assert scenario.printer.state.halted == ""
    cable.cut()
    assert cable.board.device.fault == ""
    assert cable.board.position("x") == pytest.approx(before + 2.0)


def test_heaters_are_off_when_the_printer_ends(cable: Cable) -> None:
    with Scenario(on("serial", cable.path, cable.runs), loop=asyncio.new_event_loop()) as scenario:
        scenario.host.ok("M104 S200")
        scenario.passes(2.0)
        assert scenario.printer.rig.connection.heaters["hotend"].power > 0.5
    cable.cut()
    assert cable.board.device.fault == ""
    assert cable.board.output_value("hotend") == 0
    assert cable.board.temperature("hotend") > 22.0


def test_a_board_that_is_not_there_is_named() -> None:
    with pytest.raises(MachineError, match="cannot be reached at /dev/nothing: No such file"):
        connect(on("serial", "/dev/nothing"))
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    with pytest.raises(MachineError, match=f"127.0.0.1:{port}: Connection refused"):
        connect(on("tcp", f"127.0.0.1:{port}"))
