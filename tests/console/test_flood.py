"""A host that sends more than can be carried out."""

import asyncio
import socket

from tests.console.scenario import Host, Scenario

from passo import config
from passo.clock import VirtualLoop
from passo.console.printer_console import furnished
from passo.console.session import Session
from passo.console.wires import open_tcp


def test_a_flood_is_read_in_pieces_so_that_others_have_their_turn(monkeypatch):
    sizes = []
    monkeypatch.setattr(Session, "receive", lambda _, data: sizes.append(len(data)))

    async def flood():
        printer = furnished(config.load("i3"))
        server = await open_tcp(printer, "127.0.0.1", 0, 1, lambda _: None)
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


def test_lines_that_take_long_let_others_have_their_turn():
    with Scenario("i3") as s:
        flooding = Host(s)

        def slow(_command, reply):
            s.loop._pass(0.001)
            reply.say("slow")

        s.printer.immediate["M503"] = slow
        s.printer.immediate["M105"] = lambda _, reply: reply.say(f"{len(flooding.heard)} heard")
        flooding.session.receive(b"M503\n" * 500)  # both before the loop looks again
        s.host.session.receive(b"M105\n")
        s.host.expect("heard", 1)
        assert int(s.host.heard[0].split()[0]) < 20
        s.until(lambda: flooding.heard.count("ok") == 500, 10)
        assert flooding.heard == ["slow", "ok"] * 500
