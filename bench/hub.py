"""What a hub costs. Usage: bench/hub.py [--printers N] [--seconds N]

Starts `passo hub`, and in this process the summaries of 200 printers over loopback, in the form of
`passo serve`. Prints CPU of the hub in percent of one core and its memory (RSS) while all printers
are idle, which send nothing, and while all print, which send progress every 2 s; and the bytes per
second that one open page receives then. The times are CPU times, which other load on the computer
changes less than wall times.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import msgspec
from aiohttp import ClientSession, WSMsgType, web

from passo.web.summary import Summary, SummaryHeater, SummaryJob

_PORT = 25_000
_HUB = 25_001
_TICKS_HZ = os.sysconf("SC_CLK_TCK")
_EVERY_S = 2.0  # between two summaries of a printer that prints


class _Printers:
    """The summaries of all printers, at `/NUMBER/api/v1`."""

    def __init__(self) -> None:
        self.prints = False
        self.followed = 0

    def summary(self, number: int) -> Summary:
        """What one of them sends now."""
        id, name = f"00000000-0000-4000-8000-{number:012}", f"Printer {number}"
        now_s = time.monotonic()
        job = None
        heaters = (SummaryHeater("hotend", 24, 0), SummaryHeater("bed", 23, 0))
        if self.prints:
            run = f"00000000-0000-4000-8001-{number:012}"
            done = round(now_s % 3600 / 3600, 3)
            job = SummaryJob(
                "/hub/bracket.gcode", run, done, 3600 - now_s % 3600, now_s, 9, 99, 1e3
            )
            shown = 210 + int(now_s + number) % 2
            heaters = (SummaryHeater("hotend", shown, 210), SummaryHeater("bed", 60, 60))
        state = "printing" if self.prints else "idle"
        return Summary(id, name, "0.1.0", state, job, None, heaters)

    async def pair(self, request: web.Request) -> web.Response:
        summary = self.summary(int(request.match_info["number"]))
        return _json({"id": summary.id, "name": summary.name, "key": "key"})

    async def machine(self, request: web.Request) -> web.Response:
        return _json({"text": "", "path": ""})

    async def feed(self, request: web.Request) -> web.WebSocketResponse:
        socket, number = web.WebSocketResponse(), int(request.match_info["number"])
        await socket.prepare(request)
        self.followed += 1
        await socket.send_str(msgspec.json.encode(self.summary(number)).decode())
        sending = asyncio.create_task(self._send(socket, number))
        async for _ in socket:  # answers pings
            pass
        sending.cancel()
        return socket

    async def _send(self, socket: web.WebSocketResponse, number: int) -> None:
        await asyncio.sleep(number % 20 / 20 * _EVERY_S)
        while True:
            if self.prints:
                await socket.send_str(msgspec.json.encode(self.summary(number)).decode())
            await asyncio.sleep(_EVERY_S)


def _json(body: Any) -> web.Response:
    return web.Response(body=msgspec.json.encode(body), content_type="application/json")


async def main(count: int, seconds: float) -> None:
    printers, api = _Printers(), "/{number}/api/v1"
    app = web.Application()
    app.router.add_post(f"{api}/pair", printers.pair)
    app.router.add_get(f"{api}/machine/file", printers.machine)
    app.router.add_get(f"{api}/summary/feed", printers.feed)
    runner = web.AppRunner(app)
    await runner.setup()
    await web.TCPSite(runner, "127.0.0.1", _PORT).start()
    url = f"http://127.0.0.1:{_HUB}/api/v1"
    with tempfile.TemporaryDirectory() as folder:
        words = ["-m", "passo", "hub", "--http", f"127.0.0.1:{_HUB}", "--state", folder]
        hub = subprocess.Popen([sys.executable, *words], stderr=subprocess.PIPE)
        try:
            assert hub.stderr is not None
            await asyncio.to_thread(hub.stderr.readline)
            async with ClientSession() as client:
                for number in range(count):
                    body = {"url": f"http://127.0.0.1:{_PORT}/{number}"}
                    async with client.post(f"{url}/printers", json=body) as answer:
                        assert answer.status == 201, await answer.text()
                while printers.followed < count:
                    await asyncio.sleep(0.5)
                await asyncio.sleep(5)
                await _measure(hub.pid, f"{count} idle printers", seconds)
                await _page(client, url, hub.pid, f"{count} idle printers, one page", seconds)
                printers.prints = True
                await asyncio.sleep(5)
                await _measure(hub.pid, f"{count} printing printers", seconds)
                await _page(client, url, hub.pid, f"{count} printing, one page", seconds)
        finally:
            hub.kill()
            hub.wait()
    await runner.cleanup()


async def _measure(pid: int, what: str, seconds: float, more: str = "") -> None:
    before_s, begun_s = _cpu_s(pid), time.monotonic()
    await asyncio.sleep(seconds)
    percent = (_cpu_s(pid) - before_s) / (time.monotonic() - begun_s) * 100
    print(f"{what}: {percent:.1f} % of a core, {_rss_mb(pid):.0f} MB{more}", flush=True)


async def _page(client: ClientSession, url: str, pid: int, what: str, seconds: float) -> None:
    async with client.ws_connect(f"{url}/feed", max_msg_size=0) as socket:
        first = await socket.receive()
        counted = 0

        async def count() -> None:
            nonlocal counted
            async for message in socket:
                if message.type is WSMsgType.TEXT:
                    counted += len(message.data)

        counting = asyncio.create_task(count())
        begun_s = time.monotonic()
        await _measure(pid, what, seconds)
        rate = counted / (time.monotonic() - begun_s) / 1000
        counting.cancel()
        print(
            f"  the page: {len(first.data) / 1000:.0f} kB first, then {rate:.1f} kB/s", flush=True
        )


def _cpu_s(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICKS_HZ


def _rss_mb(pid: int) -> float:
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS")) / 1000


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--printers", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=30.0)
    arguments = parser.parse_args()
    asyncio.run(main(arguments.printers, arguments.seconds))
