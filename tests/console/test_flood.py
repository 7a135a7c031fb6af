"""A host that sends more than can be carried out."""

import asyncio
import socket

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
