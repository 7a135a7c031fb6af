"""The hub's link to an unchanged Moonraker, on `passo serve --klippy-socket`."""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.hosts.moonraker import Moonraker
from tests.hosts.served import Served

from passo.hub.link import Refused, RunReport, StartUnknown, Unreachable
from passo.hub.links.http import session
from passo.hub.links.moonraker import MoonrakerLink, pair
from passo.hub.wishes import NewPrinter
from passo.web.summary import Summary

FIRST, SECOND, THIRD = (f"0000000{n}-0000-4000-8000-000000000000" for n in (1, 2, 3))
PRINT = "G28\nG1 Z5 F600\n" + "G1 X20 Y20 F3000\nG1 X120 Y20\n" * 400
WAIT_S = 60.0


@pytest.fixture(scope="module")
def server(hosts, tmp_path_factory):
    printer = Served(tmp_path_factory.mktemp("printer"), clock="4", klippy=True)
    folder = tmp_path_factory.mktemp("moonraker")
    moonraker = Moonraker(hosts / "moonraker", folder, printer.klippy, printer.card)
    yield moonraker
    moonraker.close()
    printer.close()


def with_link(server: Moonraker, test: Callable[[MoonrakerLink], Any]) -> None:
    """Runs a test with a link to the server."""

    async def main() -> None:
        async with session() as connections:
            record = await pair(connections, NewPrinter(server.url, "moonraker"))
            assert (await pair(connections, NewPrinter(server.url, "moonraker"))).id == record.id
            await test(MoonrakerLink(connections, record))

    asyncio.run(main())


async def until(link: MoonrakerLink, condition: Callable[[Summary], object]) -> Summary:
    """The first summary of the feed for which the condition holds."""
    found: asyncio.Future[Summary] = asyncio.get_running_loop().create_future()

    def seen(summary: Summary) -> None:
        if condition(summary) and not found.done():
            found.set_result(summary)

    async def follow() -> None:
        while True:
            try:
                await link.follow(seen)
            except Unreachable:
                await asyncio.sleep(0.1)

    following = asyncio.create_task(follow())
    try:
        async with asyncio.timeout(WAIT_S):
            return await found
    finally:
        following.cancel()


async def uploaded(link: MoonrakerLink, folder: Path) -> str:
    content = folder / "content"
    content.write_text(PRINT)
    sha256 = hashlib.sha256(content.read_bytes()).hexdigest()
    return await link.upload(content, "part.gcode", sha256)


def test_run_is_found_in_the_print_and_in_the_history(server, tmp_path):
    async def test(link: MoonrakerLink) -> None:
        path = await uploaded(link, tmp_path)
        assert await link.report(FIRST) is None
        await link.start(FIRST, path, "anna")
        shown = await until(link, lambda seen: seen.state == "printing")
        assert shown.job is not None
        assert (shown.job.run, shown.job.file) == (FIRST, f"hub/{FIRST}/part.gcode")
        assert await link.report(FIRST) == RunReport("printing")
        await link.start(FIRST, path, "anna")  # known: nothing happens
        await link.pause("anna")
        await until(link, lambda seen: seen.state == "paused")
        assert await link.report(FIRST) == RunReport("paused")
        await link.resume("anna")
        await until(link, lambda seen: seen.state == "printing")
        await link.cancel("anna")
        ended = await until(link, lambda seen: seen.state == "idle" and seen.last_print)
        assert ended.last_print is not None
        assert (ended.last_print.run, ended.last_print.result) == (FIRST, "cancelled")
        assert await link.report(FIRST) == RunReport("cancelled")
        await link.start(FIRST, path, "anna")  # over: nothing happens
        assert server.print_state == "cancelled"

    with_link(server, test)


def test_file_with_another_hash_is_refused(server, tmp_path):
    async def test(link: MoonrakerLink) -> None:
        content = tmp_path / "content"
        content.write_text(PRINT)
        with pytest.raises(Refused, match="another content"):
            await link.upload(content, "part.gcode", "0" * 64)

    with_link(server, test)


def test_start_that_may_be_on_its_way_is_unknown(server, tmp_path):
    """The hub was killed between the move of the file and the answer to the start."""

    async def test(link: MoonrakerLink) -> None:
        path = await uploaded(link, tmp_path)
        server.post("/server/files/directory", path=f"gcodes/hub/{SECOND}")
        with pytest.raises(StartUnknown):
            await link.report(SECOND)
        with pytest.raises(StartUnknown):
            await link.start(SECOND, path, "anna")
        assert server.print_state != "printing"

    with_link(server, test)


def test_emergency_stop_halts_and_fails_the_run(server, tmp_path):
    async def test(link: MoonrakerLink) -> None:
        await link.start(THIRD, await uploaded(link, tmp_path), "anna")
        await until(link, lambda seen: seen.state == "printing")
        await link.stop("anna")
        halted = await until(link, lambda seen: seen.last_print and seen.last_print.run == THIRD)
        assert halted.state == "halted" and halted.fault is not None
        async with asyncio.timeout(WAIT_S):
            while (report := await link.report(THIRD)) == RunReport("printing"):
                await asyncio.sleep(0.05)
        assert report is not None and report.state == "failed"
        server.post("/printer/firmware_restart")
        await until(link, lambda seen: seen.state == "idle")

    with_link(server, test)
