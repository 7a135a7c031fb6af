"""Two boards, each on a cable of its own, in real time."""

from __future__ import annotations

import asyncio
import shutil
import time
from collections.abc import Iterator

import pytest
from tests.live.cable import Cable
from tests.live.prints import ZIGZAG_STEPS, ends, net_steps, stall, zigzag
from tests.support.scenario import Scenario
from tests.support.two_boards import two_boards

from passo.config.machine import MachineConfig

MACHINE = two_boards(**{'socket = "X"': 'socket = "tool:X"'})


def on(cables: dict[str, Cable]) -> MachineConfig:
    """The machine with its boards on these cables."""
    boards = {
        name: board.model_copy(
            update={"link": "serial", "port": cables[name].path, "firmware": cables[name].runs}
        )
        for name, board in MACHINE.all_boards.items()
    }
    return MACHINE.model_copy(update={"board": boards.pop(""), "boards": boards})


@pytest.fixture
def cables() -> Iterator[dict[str, Cable]]:
    cables = {name: Cable(MACHINE, name) for name in MACHINE.all_boards}
    yield cables
    for cable in cables.values():
        cable.close()


@pytest.fixture
def scenario(cables: dict[str, Cable]) -> Iterator[Scenario]:
    """What may be looked at when it is closed: the boards are unplugged then."""
    machine = on(cables)
    scenario = Scenario(machine, loop=asyncio.new_event_loop())
    yield scenario
    if not scenario.loop.is_closed():
        scenario.__exit__()


def unplugged(scenario: Scenario, cables: dict[str, Cable]) -> dict[str, int]:
    """Net steps of all motors, when the printer is gone."""
    scenario.__exit__()
    return net_steps(cables.values())


def test_a_stall_of_the_interpreter_delays_no_step(scenario, cables):
    zigzag(scenario.host)
    scenario.passes(0.8)
    stall()
    scenario.until(lambda: scenario.printer.rig.queue.standing, 20.0)
    assert scenario.printer.state.halted == ""
    assert unplugged(scenario, cables) == ZIGZAG_STEPS


def test_a_switch_stops_a_motor_on_the_other_board(scenario, cables):
    host, main, tool = scenario.host, cables[""], cables["tool"]
    main.look(lambda: main.board.force_switch("x", False))
    start = tool.look(lambda: tool.board.position("x"))
    host.send("G28 X")
    scenario.until(lambda: tool.look(lambda: tool.board.position("x")) < start - 10, 10.0)
    main.look(lambda: main.board.force_switch("x", True))
    hit = tool.look(lambda: tool.board.position("x"))
    # It lets go as the motor moves back.
    scenario.passes(0.05)
    stopped = tool.look(lambda: tool.board.position("x"))
    assert hit - 40 * 0.05 < stopped <= hit
    main.look(lambda: main.board.force_switch("x", False))
    scenario.until(lambda: tool.look(lambda: tool.board.position("x")) > stopped + 2.9, 10.0)
    scenario.until(lambda: tool.look(lambda: tool.board.position("x")) < stopped + 2.0, 10.0)
    main.look(lambda: main.board.force_switch("x", True))
    host.expect("^ok", 10.0)
    assert scenario.printer.state.halted == ""
    assert 0 not in scenario.printer.rig.job.locked_axes


def test_a_board_plugged_in_again_continues_with_the_other() -> None:
    machine = two_boards(firmware="passo", **{'socket = "X"': 'socket = "tool:X"'})
    cables = {name: Cable(machine, name) for name in machine.all_boards}
    scenario = Scenario(on(cables), loop=asyncio.new_event_loop())
    with scenario:
        zigzag(scenario.host)
        for cable in cables.values():
            scenario.passes(0.8)
            cable.unplug()
            scenario.passes(1.0)
            cable.plug()
            scenario.host.expect("at the positions where they stopped", 20.0)
        ends(scenario, 30.0)
    assert net_steps(cables.values()) == ZIGZAG_STEPS
    for cable in cables.values():
        cable.close()


def test_a_board_that_is_unplugged_stops_the_other(scenario, cables):
    host, main = scenario.host, cables[""]
    host.ok("G92 X0 Y0 Z0")
    host.ok("M302 P1")
    host.send("G1 Y100 E20 F1200")
    scenario.passes(1.5)
    cables["tool"].cut()
    host.expect("connection to the board has ended", 5.0)
    scenario.until(lambda: bool(main.look(lambda: main.board.device.fault)), 2.0)
    at = main.look(lambda: main.board.position("y"))
    scenario.passes(0.3)
    assert main.look(lambda: main.board.position("y")) == at


def test_another_host_resumes_where_both_boards_have_stopped(tmp_path) -> None:
    """The one before falls silent in mid-print: nothing is homed again."""
    machine = two_boards(firmware="passo", **{'socket = "X"': 'socket = "tool:X"'})
    cables = {name: Cable(machine, name) for name in machine.all_boards}
    wired = on(cables)
    card = tmp_path / "card"
    card.mkdir()
    moves = [f"G1 X{60 if i % 2 else 40} Y{40 + i / 4} F3000" for i in range(16)]
    begin = ["M302 P1", "G92 X0 Y0 Z0", "G1 X40 Y40 Z1 F6000"]
    (card / "a.g").write_text("\n".join([*begin, *moves]) + "\n")
    places = {"card": str(card), "state": str(tmp_path / "state")}
    scenario = Scenario(wired, **places, loop=asyncio.new_event_loop())
    scenario.host.send("M32 a.g")
    main, tool = cables[""], cables["tool"]
    start = main.look(lambda: main.board.position("y"))
    assert scenario.until(lambda: main.look(lambda: main.board.position("y")) > start + 41, 60.0)
    for connection in scenario.printer.rig.connection.connections:
        connection.wire.stop()
    time.sleep(0.8)
    stopped = tool.look(lambda: tool.board.position("x"))
    # The first host holds its folder in this process: a dead one would not.
    shutil.copytree(tmp_path / "state", tmp_path / "left")
    places["state"] = str(tmp_path / "left")
    with Scenario(wired, **places, loop=asyncio.new_event_loop()) as other:
        assert other.printer.rig.connection.adopted
        assert tool.look(lambda: tool.board.position("x")) == stopped
        other.host.send("M1000")
        other.host.expect("Printing a.g from line", 20.0)
        other.host.expect("Done printing", 90.0)
        assert other.printer.state.halted == ""
    for cable in cables.values():
        cable.cut()
        assert cable.board.device.fault == ""
    assert net_steps(cables.values()) == {"x": 4800, "y": 3500, "z": 400, "e": 478}  # the fill
    scenario.__exit__()
    for cable in cables.values():
        cable.close()
