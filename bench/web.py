"""How the web interface holds under load, during a print. Usage: bench/web.py

WebSocket clients on one printer that prints from its card: 20 that listen, then 500, and for each
ten of them one more that runs a script a second. Prints the delay of `ok` on a TCP console, without
and with the clients, how long a status takes, and what the link has counted by then (M122): late
frames, and its least slack. Then, how long a status takes while a file of 50 MB is uploaded and
planned.
`waited` is how long threads of the server were ready and had no processor: on a computer that does
other work, too, delays are not those of Passo.
"""

from __future__ import annotations

import asyncio
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path

from websockets.asyncio.client import connect

import passo

CLIENTS = (20, 500)  # that listen; one more for each ten of them runs scripts
SECONDS = 10.0
PACE_S = 0.02
UPLOAD_MB = 50


def served(folder: Path) -> tuple[subprocess.Popen[str], str, int]:
    """`passo serve` with a long file on its card: the process, the web's address, the TCP port."""
    moves = "".join(f"G1 X{10 + i % 2 * 180} Y{10 + i % 180} F9000\n" for i in range(20_000))
    (folder / "part.gcode").write_text(f"G28\n{moves}")
    command = [sys.executable, "-m", "passo", "serve", "--machine", "i3", "--sd", str(folder)]
    command += ["--tcp", "127.0.0.1:0", "--http", "127.0.0.1:0"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    line = next(line for line in process.stderr if line.startswith("Serving"))
    threading.Thread(target=process.stderr.read, daemon=True).start()  # what it logs
    tcp, web = (part.strip(" .\n") for part in line.rpartition(" on ")[2].split(","))
    return process, web, int(tcp.rpartition(":")[2])


async def oks(port: int) -> list[float]:
    """Seconds until each `ok` of a console that asks for temperatures."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    found: list[float] = []
    end = time.perf_counter() + SECONDS
    while (start := time.perf_counter()) < end:
        writer.write(b"M105\n")
        while not (await reader.readline()).startswith(b"ok"):
            pass
        found.append(time.perf_counter() - start)
        await asyncio.sleep(PACE_S)
    writer.close()
    return found


async def link_report(port: int) -> str:
    """The line of M122 that has the late frames since the start."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(b"M122\n")
    while not (line := (await reader.readline()).decode()).startswith("Link"):
        pass
    writer.close()
    return line.strip()


async def listen(place: str, answers: list[float], *, active: bool) -> None:
    """One client of the feed; an active one asks for temperatures each second."""
    async with connect(place, compression=None, ping_interval=None) as feed:
        if not active:
            async for _ in feed:
                pass
        for number in range(1_000_000):
            start = time.perf_counter()
            await feed.send(json.dumps({"type": "script", "id": number, "script": "M105"}))
            while json.loads(await feed.recv()).get("id") != number:
                pass
            answers.append(time.perf_counter() - start)
            await asyncio.sleep(1)


async def statuses(place: str, going: Callable[[], bool]) -> list[float]:
    """Seconds that each status takes, while `going`."""
    client = passo.AsyncClient(place)
    found: list[float] = []
    while going():
        start = time.perf_counter()
        await client.status.get()
        found.append(time.perf_counter() - start)
        await asyncio.sleep(PACE_S)
    return found


def for_a_while() -> Callable[[], bool]:
    """True for the time of one measurement."""
    end = time.perf_counter() + SECONDS
    return lambda: time.perf_counter() < end


def long_file() -> bytes:
    """A print in spirals, with heat and fan, of `UPLOAD_MB`."""
    lines = ["G28\nM190 S60\nM109 S200\nM83\nG1 F1800\n"]
    size, number = 0, 0
    while size < UPLOAD_MB * 1_000_000:
        number += 1
        angle, radius = number * 0.05, 20 + 20 * math.sin(number * 0.001)
        x, y = 100 + radius * math.cos(angle), 100 + radius * math.sin(angle)
        line = f"G1 X{x:.3f} Y{y:.3f} E0.03000\n"
        if number % 5000 == 0:
            line += (
                f";LAYER:{number // 5000}\nM106 S{number // 5000 % 255}\nG1 Z{number / 25000:.2f}\n"
            )
        lines.append(line)
        size += len(line)
    return "".join(lines).encode()


def upload(place: str, data: bytes) -> None:
    """Uploads a file, and waits until it is planned."""
    client = passo.Client(place)
    client.files.upload(data, path="long.gcode")
    while client.files.metadata(path="long.gcode").state == "pending":
        time.sleep(PACE_S)


async def while_planning(web: str) -> None:
    """Measures statuses while a long file is uploaded and planned."""
    data = long_file()
    start = time.perf_counter()
    work = asyncio.create_task(asyncio.to_thread(upload, web, data))
    shown("status, while a file is planned", await statuses(web, lambda: not work.done()))
    await work
    print(f"{len(data) / 1e6:.0f} MB planned {time.perf_counter() - start:.1f} s after the start")


def waited_s(pid: int) -> float:
    """Of all threads of a process, until now (Documentation/scheduler/sched-stats.rst of Linux)."""
    tasks = Path(f"/proc/{pid}/task").iterdir()
    return sum(int((task / "schedstat").read_text().split()[1]) for task in tasks) / 1e9


def shown(name: str, times: list[float]) -> None:
    ordered = sorted(times)
    p99 = ordered[int(len(ordered) * 0.99)]
    median, worst = statistics.median(ordered), ordered[-1]
    text = f"median {median * 1e3:6.1f} ms, p99 {p99 * 1e3:6.1f} ms, worst {worst * 1e3:6.1f} ms"
    print(f"{name:34}{text}, of {len(ordered)}", flush=True)


async def measure(web: str, port: int, pid: int) -> None:
    client = passo.AsyncClient(web)
    await client.job.start("part.gcode")
    await asyncio.sleep(1)
    shown("ok, no web clients", await oks(port))
    shown("status, no web clients", await statuses(web, for_a_while()))
    print(await link_report(port), flush=True)
    for count in CLIENTS:
        # In a process of their own: what these clients do is not what is measured.
        load = subprocess.Popen([sys.executable, __file__, web, str(count)])
        await asyncio.sleep(5)
        before_s = waited_s(pid)
        shown(f"ok, {count} idle and {count // 10} active", await oks(port))
        shown(f"status, {count} idle and {count // 10} active", await statuses(web, for_a_while()))
        print(await link_report(port), flush=True)
        print(f"waited {waited_s(pid) - before_s:.2f} s of {2 * SECONDS:.0f} s", flush=True)
        load.wait()
    await while_planning(web)
    status = (await client.status.get()).status
    print(f"state {status.state.name}, faults {len(status.faults)}")


async def load(web: str, count: int) -> None:
    """So many clients that listen, and the active ones, for as long as the measurements take."""
    answers: list[float] = []
    place = f"ws{web.removeprefix('http')}/api/v1/feed"
    clients = [
        asyncio.create_task(listen(place, answers, active=number < count // 10))
        for number in range(count + count // 10)
    ]
    _, running = await asyncio.wait(clients, timeout=2 * SECONDS + 6)
    shown("scripts of the active clients", answers)
    print(f"clients lost: {len(clients) - len(running)}")
    for task in running:
        task.cancel()


def main() -> None:
    if sys.argv[1:]:
        os.nice(10)  # clients have processors of their own
        return asyncio.run(load(sys.argv[1], int(sys.argv[2])))
    with tempfile.TemporaryDirectory() as folder:
        process, web, port = served(Path(folder))
        try:
            asyncio.run(measure(web, port, process.pid))
        finally:
            process.terminate()
            process.wait()


if __name__ == "__main__":
    main()
