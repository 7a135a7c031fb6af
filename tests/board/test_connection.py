"""A whole session: identify, configure, run, reconnect, fail."""

from __future__ import annotations

import asyncio
import socket
import threading
from dataclasses import replace

import pytest
from tests.support.link_bench import (
    HZ,
    MS,
    PLANT,
    START,
    Bench,
    Kind,
    LateLink,
    Planner,
    description,
    executed,
)

from passo import _core
from passo.board.connection import Connection
from passo.board.dictionary import Dictionary, decode
from passo.board.faults import BoardSilentError
from passo.board.ports import InProcess, LinkLostError, LivePort
from passo.errors import MachineError
from passo.simulator import SimulatedBoard
from passo.simulator.dictionary import compressed_dictionary


def test_connect_identifies_configures_and_follows_the_clock():
    bench = Bench()
    c = bench.connection
    assert c.move_count == 1024
    assert c.dictionary.number("CLOCK_FREQ") == HZ
    bench.run(10.0)
    assert c.link.clock_rate == 1.0
    assert c.link.clock_at(c.now) == c.now == START + 10 * HZ
    state = c.ask("get_config", "config")
    assert (state["is_config"], state["is_shutdown"]) == (1, 0)


def test_firmware_without_survive_is_refused_if_expected():
    with pytest.raises(MachineError) as error:
        Bench(replace(description(), survives=True))
    assert str(error.value) == (
        "the board's dictionary does not fit the machine file: it runs Klipper's firmware, or the"
        ' like, which `firmware = "klipper"` would say. Choose the right board and firmware in the'
        " machine file, or build the firmware for it."
    )
    assert error.value.status == 5


def test_firmware_with_survive_is_refused_if_not_expected(monkeypatch):
    monkeypatch.setattr(Kind, "firmware", "passo")
    with pytest.raises(MachineError, match="it runs Passo's firmware, and is taken to run Klipper"):
        Bench(replace(description(), survives=False))


def test_a_job_is_executed_to_the_tick():
    bench = Bench()
    plan = Planner()
    plan.steps(0, True, 40_000, 100, 5)
    plan.steps(1, True, 1_000_000, 3)
    plan.steps(0, False, 30_000, 250, -7)
    plan.pin(0, 3_000_000, 80_000)
    plan.steps(1, False, 65_536, 65, 12)
    for name in ("x", "y"):
        bench.simulated.trace_steps(name, 0, 2**62)
    bench.simulated.trace_output("fan")
    base = bench.connection.start_job(plan.queue)
    bench.run(5.0)
    assert executed(bench, "x", base) == (plan.clocks[0], plan.directions[0])
    assert executed(bench, "y", base) == (plan.clocks[1], plan.directions[1])
    assert bench.simulated.net_steps("x") == -150
    assert bench.simulated.net_steps("y") == -62
    assert bench.simulated.steps("x") == 350
    assert bench.simulated.position("x") == 10.0 - 150 / 80
    assert bench.simulated.position("y") == -62 / 80
    assert bench.simulated.take_changes("fan") == [(base + 3_000_000, 80_000)]
    assert bench.link.queue_steps == 4
    assert bench.link.messages == 9
    assert len(plan.queue) == 0


def test_all_bytes_of_a_session_can_be_read():
    bench = Bench()
    bench.connection.wire.record(True)
    before = bench.link.wire_bytes
    plan = Planner()
    plan.steps(0, True, 1234, 10, -3, lead=0)
    bench.connection.start_job(plan.queue)
    bench.run(0.3)
    recorded = bench.connection.wire.take_recorded()
    assert len(recorded) == bench.link.wire_bytes - before
    lines = decode(recorded, bench.connection.dictionary)
    assert "queue_step oid=0 interval=1234 count=10 add=-3" in lines
    assert "set_next_step_dir oid=0 dir=1" in lines


def test_a_board_that_was_in_use_is_reset():
    """Nobody knows what it was doing: its laser may be on, its endstops armed."""
    bench = Bench()
    second = Connection(bench.board, bench.connection.port)
    second.wire.record(True)
    second.connect()
    lines = decode(second.wire.take_recorded(), second.dictionary)
    assert "reset" in lines
    assert [line for line in lines if line.startswith("finalize")]
    assert second.move_count == 1024


def test_board_with_another_configuration_is_reset():
    simulated = SimulatedBoard(description(), PLANT, START)
    first = Connection(description(), InProcess(simulated.device, START))
    first.connect()
    plan = Planner()
    plan.steps(0, True, 4000, 400)
    first.start_job(plan.queue)
    first.run(first.now + HZ)
    assert simulated.net_steps("x") == 400
    second = Connection(description(pwm=True), first.port)
    second.connect()
    assert simulated.net_steps("x") == 0
    assert simulated.position("x") == 15.0, "the actuator stays where it was"
    assert second.ask("get_config", "config")["is_config"] == 1


def test_shut_down_board_answers_with_its_reason():
    bench = Bench()
    bench.connection.command("emergency_stop")
    with pytest.raises(MachineError, match="shut down: Command request"):
        bench.connection.net_steps("x")


def test_a_board_that_is_shut_down_is_reset():
    bench = Bench()
    bench.connection.command("emergency_stop")
    with pytest.raises(MachineError, match="Command request"):
        bench.run(1.0)
    Connection(bench.board, bench.connection.port).connect()
    assert bench.device.fault == ""


@pytest.mark.parametrize("ms", [0, 5, 18, 30])
def test_late_bytes_of_an_old_link_are_ignored(ms):
    bench = Bench()
    late = _core.Distant(bench.device, 0, 0.0, 10 * MS, 2 * MS, 1)
    port = InProcess(late, START)
    first = Connection(bench.board, port)
    first.connect()
    for _ in range(11):  # each leaves in a frame of its own
        first.command("get_config")
        first.pass_time(first.now)
    first.pass_time(first.now + ms * MS)
    second = Connection(bench.board, port)
    second.connect()
    assert second.ask("get_config", "config")["is_config"] == 1


def test_a_board_without_a_dictionary_is_refused():
    empty = _core.VirtualBoard(16e6, 16, 1023, 255, b"", 0)
    connection = Connection(description(), InProcess(empty))
    with pytest.raises(MachineError, match=r"dictionary does not fit.*damaged"):
        connection.connect()


def test_board_with_another_clock_frequency_is_refused():
    bench = Bench()
    other = replace(description(), clock_hz=HZ * 5 // 4)
    connection = Connection(other, InProcess(bench.device))
    with pytest.raises(MachineError, match="machine file: its clock has 16 MHz, not 20 MHz"):
        connection.connect()


def test_unanswered_query_is_named_in_the_error():
    bench = Bench()
    with pytest.raises(BoardSilentError, match="debug_nop"):
        bench.connection.ask("debug_nop", "pong")
    assert bench.connection.ask("debug_ping data=0a7e0b", "pong") == {"data": b"\x0a\x7e\x0b"}


def test_a_late_answer_is_not_sent_to_another_client():
    bench = Bench()
    plan = Planner()
    plan.steps(0, True, 40_000, 7)
    plan.steps(1, True, 40_000, 12)
    bench.connection.start_job(plan.queue)
    bench.run(2.0)
    bench.connection.link = LateLink(bench, "stepper_position", 0.7)
    # Each question is repeated before its answer comes, and the repetition's answer comes too.
    assert bench.connection.net_steps("x") == 7
    assert bench.connection.net_steps("y") == 12
    assert bench.connection.net_steps("x") == 7


def test_late_answer_is_not_used_for_a_new_query():
    bench = Bench()
    plan = Planner()
    plan.steps(0, True, 40_000, 7)
    bench.connection.start_job(plan.queue)
    bench.run(2.0)
    bench.connection.link = LateLink(bench, "stepper_position", 0.7)
    assert bench.connection.net_steps("x") == 7
    bench.link.stop_job()
    more = Planner()
    more.steps(0, True, 4_000, 5)
    bench.connection.start_job(more.queue, bench.connection.now + HZ // 10)
    bench.run(0.3)
    assert bench.connection.net_steps("x") == 12  # the answer to the repetition said 7


def test_the_loop_continues_while_a_lost_port_is_opened():
    heard = threading.Event()
    near, far = socket.socketpair()
    descriptors = [near.detach()]

    def opened() -> int:
        if descriptors:
            return descriptors.pop()
        assert heard.wait(10)  # the network's patience
        raise LinkLostError.of("machine.unreachable", axis="far:1", value="timed out")

    async def reopen(connection: Connection) -> None:
        task = asyncio.ensure_future(connection.reopen())
        await asyncio.sleep(0)
        heard.set()  # M112 gets its turn
        with pytest.raises(LinkLostError, match="timed out"):
            await task

    with far:
        connection = Connection(description(), LivePort(opened))
        asyncio.run(reopen(connection))


def test_unrequested_reports_are_kept_in_order():
    bench = Bench()
    bench.connection.command("debug_ping data=01")
    bench.connection.command("debug_ping data=02")
    bench.run(0.001)
    bench.connection.ask("get_config", "config")
    taken = [v for name, v in bench.connection.take_responses() if name == "pong"]
    assert taken == [{"data": b"\x01"}, {"data": b"\x02"}]
    assert bench.connection.take_responses() == []


def test_board_sends_the_simulators_dictionary():
    bench = Bench()
    assert bench.connection.dictionary == Dictionary.parse(compressed_dictionary(bench.board))
    assert bench.connection.dictionary.name_of("static_string_id", 2) == "Timer too close"
