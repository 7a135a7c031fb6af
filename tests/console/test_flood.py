"""A host that sends more than can be carried out."""

import asyncio
import gc
import socket
import weakref

import pytest
from tests.support.scenario import Host, Scenario

from passo import config
from passo.clock import VirtualLoop
from passo.console.session import Session
from passo.console.transports.streams import open_tcp
from passo.library.assembly import assembled


def test_flood_of_input_is_read_in_portions(monkeypatch):
    sizes = []
    monkeypatch.setattr(Session, "receive", lambda _, data: sizes.append(len(data)))

    async def flood():
        printer = assembled(config.load("i3")).printer
        server = await open_tcp(lambda wire: Session(printer.control, wire), "127.0.0.1", 0, 1)
        host, _, port = server.place.removeprefix("tcp ").rpartition(":")
        with socket.create_connection((host, int(port))) as client:
            client.setblocking(False)
            sent = client.send(b"M105\n" * 20_000)
            while sum(sizes) < sent:
                await asyncio.sleep(0)
        server.close()
        await asyncio.sleep(1)

    loop = VirtualLoop()
    loop.run_until_complete(flood())
    loop.close()
    assert sum(sizes) > 50_000
    assert max(sizes) <= 4096


def test_slow_lines_do_not_block_other_consoles():
    with Scenario("i3") as s:
        flooding = Host(s)

        def slow(_command, reply):
            s.loop.pass_time(0.001)
            reply.say("slow")

        s.printer.dispatch.immediate["M503"] = slow
        s.printer.dispatch.immediate["M105"] = lambda _, reply: reply.say(
            f"{len(flooding.heard)} heard"
        )
        flooding.session.receive(b"M503\n" * 500)  # both before the loop looks again
        s.host.session.receive(b"M105\n")
        s.host.expect("heard", 1)
        assert int(s.host.heard[0].split()[0]) < 20
        s.until(lambda: flooding.heard.count("ok") == 500, 10)
        assert flooding.heard == ["slow", "ok"] * 500


def kept(s):
    """What a console must not leave behind: who listens, and tasks."""

    async def counted():
        return (
            len(s.printer.state.listeners),
            len(s.printer.state.stop_listeners),
            len(asyncio.all_tasks()),
        )

    return s.run(counted())


def closed(s, hosts):
    async def close():
        for host in hosts:
            host.session.close()

    s.run(close())


def oks(host):
    return [line for line in host.heard if line.startswith("ok")]


def test_after_200_consoles_the_printer_is_as_it_was():
    """Half of them stay to their last answer; the others go in the midst of their lines, while one
    waits for the end of a dwell, or for its turn to wait for it."""
    lines = ["M105"] * 20 + ["G1 X0.2 F6000"] * 5 + ["M105"]
    with Scenario("i3") as s:
        for line in ("G28", "M104 S45", "M106 S128", "G91"):
            s.host.ok(line, 60)
        before = kept(s)
        hosts = [Host(s) for _ in range(200)]
        staying, going = hosts[::2], hosts[1::2]
        sessions = weakref.WeakSet(host.session for host in hosts)
        for one, other in zip(staying, going, strict=True):
            one.send(*lines)
            other.send("M155 S1", *["M105"] * 20, "G4 P200", "M400", *["M105"] * 1000)
        assert kept(s)[:2] == (before[0] + 200, before[1] + 200)
        for part in range(4):
            s.passes(0.15 * part)
            closed(s, going[part::4])
        assert kept(s)[:2] == (before[0] + 100, before[1] + 100)
        answered = [len(oks(host)) for host in going]
        assert set(answered) == {21, 22}  # before G4, or before M400
        assert s.until(lambda: min(len(oks(host)) for host in hosts[::2]) == len(lines), 60)
        for host in staying:
            assert [" T:" in ok for ok in oks(host)] == [line == "M105" for line in lines]
        s.host.ok("M400", 60)
        closed(s, staying)
        s.passes(0.1)
        assert kept(s) == before
        told = [len(host.heard) for host in hosts]
        s.printer.state.tell("to all")
        assert [len(host.heard) for host in hosts] == told
        assert s.host.ok("M114")[0].startswith("X:100.000 Y:0.000 Z:0.000 E:0.0000 ")
        assert s.positions() == {"x": 100.0, "y": 0.0, "z": 0.0, "e": 0.0}
        assert s.printer.state.halted == ""
        assert s.printer.rig.commands.outputs.fans["part"] == pytest.approx(128 / 255)
        targets = {name: heater.target for name, heater in s.printer.rig.connection.heaters.items()}
        assert targets == {"hotend": 45.0, "bed": 0.0}
        s.passes(60)
        assert s.board.temperature("hotend") == pytest.approx(45, abs=1.5)
        s.host.ok("G1 X-100 F6000")
        s.host.ok("M400")
        assert s.positions() == {"x": 0.0, "y": 0.0, "z": 0.0, "e": 0.0}
        hosts, staying, going, host, one, other = [None] * 6
        gc.collect()  # sessions are in circles
        assert len(sessions) == 0  # not even the one that had moved last, now that another has
