"""The fake printer of the farm's tests answers a hub as a real `passo serve` does."""

from __future__ import annotations

import asyncio
import contextlib
import subprocess
from collections.abc import AsyncGenerator
from pathlib import Path
from random import Random
from urllib.parse import urlsplit

from tests.support.card_images import ENVIRONMENT
from tests.support.fake_printer import FakeLink, FakePrinter, Network
from tests.support.link_contract import EXPECTED, observations
from tests.support.served_printer import ServedPrinter

from passo.clock import VirtualLoop
from passo.hub.links.http import session
from passo.hub.links.passo import PassoLink, pair
from passo.hub.wishes import NewPrinter

_CARD = 64 << 20
_LARGE = 60 << 20  # more than the card has beside its reserve
# It homes, and moves for a quarter of an hour of print time.
_PRINT = "G28\nG1 Z5 F600\n" + "G1 X20 Y20 F3000\nG1 X120 Y20\n" * 400


class FakeBench:
    def __init__(self, folder: Path) -> None:
        self._folder, self._printer = folder, FakePrinter("mk3")
        self.link = FakeLink(self._printer, Random(1), Network())
        self.lossy = FakeLink(self._printer, Random(1), Network(unanswered=1.0))

    def file(self) -> Path:
        path = self._folder / "fake.gcode"
        path.write_text(_PRINT)
        return path

    def too_large(self) -> Path:
        self._printer.full = True
        return self.file()

    async def restart(self) -> None:
        self._printer.disconnect()
        self._printer.restart()


class RealBench:
    def __init__(self, folder: Path, printer: ServedPrinter, link: PassoLink, lossy: PassoLink):
        self._folder, self._printer = folder, printer
        self.link, self.lossy = link, lossy

    def file(self) -> Path:
        path = self._folder / "real.gcode"
        path.write_text(_PRINT)
        return path

    def too_large(self) -> Path:
        path = self._folder / "large.gcode"
        path.write_bytes((b";" * 63 + b"\n") * (_LARGE // 64))
        return path

    async def restart(self) -> None:
        await asyncio.to_thread(self._printer.restart)


@contextlib.asynccontextmanager
async def losing_answers(url: str) -> AsyncGenerator[str]:
    """An address at which requests reach the printer, and answers are lost."""
    parts = urlsplit(url)

    async def forward(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        inner_reader, inner = await asyncio.open_connection(parts.hostname, parts.port)
        inner.write(await reader.read(1 << 16))
        await inner_reader.read(1)  # the first byte of the answer: it has taken effect
        writer.transport.abort()
        inner.close()

    server = await asyncio.start_server(forward, "127.0.0.1", 0)
    async with server:
        yield f"http://127.0.0.1:{server.sockets[0].getsockname()[1]}"


def test_fake_printer_answers_as_described(tmp_path: Path) -> None:
    loop = VirtualLoop()
    try:
        found = loop.run_until_complete(observations(FakeBench(tmp_path)))
    finally:
        loop.close()
    assert found == EXPECTED


def test_served_printer_answers_as_the_fake_one(tmp_path: Path) -> None:
    """Takes about 10 s: two starts of a process, and real time between its reports."""
    image = tmp_path / "card.img"
    with image.open("wb") as file:
        file.truncate(_CARD)
    command = ["mkfs.fat", "-F", "32", str(image)]
    subprocess.run(command, check=True, env=ENVIRONMENT, capture_output=True)
    printer = ServedPrinter(tmp_path / "printer", clock="2", card=image).serving()

    async def observe() -> list[tuple[str, object]]:
        async with session() as connections, losing_answers(printer.url) as address:
            record = await pair(connections, NewPrinter(printer.url))
            lossy = type(record)(record.id, record.name, address, record.kind, record.key)
            links = PassoLink(connections, record), PassoLink(connections, lossy)
            return await observations(RealBench(tmp_path, printer, *links))

    try:
        found = asyncio.run(observe())
    finally:
        printer.kill()
    assert found == EXPECTED
