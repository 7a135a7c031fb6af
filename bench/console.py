"""How fast `passo serve` answers: lines/s, latency of `ok`, CPU share. Usage: bench/console.py

Through a pty and TCP, each on a printer of its own in a process of its own. An echo in Python on a
bare pty shows what the system takes for its part.
"""

from __future__ import annotations

import math
import os
import select
import socket
import statistics
import subprocess
import sys
import tempfile
import time
import tty
from collections.abc import Callable
from pathlib import Path

LINES = 20_000
ROUNDS = 1_000
PACE_S = 0.01
MOVING_S = 5.0
ECHO = """
import os, sys
fd = int(sys.argv[1])
while True:
    os.write(fd, b"ok\\n" * os.read(fd, 4096).count(b"\\n"))
"""


class Line:
    """One end of a console."""

    def __init__(self, fd: int) -> None:
        self._fd = fd
        os.set_blocking(fd, False)
        self._rest = b""

    def answered(self) -> int:
        """Waits for something to read; the lines `ok` in it."""
        select.select([self._fd], [], [])
        *lines, self._rest = (self._rest + os.read(self._fd, 65536)).split(b"\n")
        for line in lines:
            if line.startswith((b"Error", b"echo:")) and not line.startswith(
                (b"echo:busy", b"echo:Passo")
            ):
                raise SystemExit(line.decode())
        return sum(line.startswith(b"ok") for line in lines)

    def ask(self, text: str) -> float:
        """Sends one line; seconds until its `ok`."""
        start = time.perf_counter()
        os.write(self._fd, text.encode() + b"\n")
        while not self.answered():
            pass
        return time.perf_counter() - start

    def pour(self, lines: list[str]) -> float:
        """Sends all lines as fast as they go; seconds until the last `ok`."""
        data = "".join(f"{line}\n" for line in lines).encode()
        start, sent, oks = time.perf_counter(), 0, 0
        while oks < len(lines):
            wanted = [self._fd] if sent < len(data) else []
            _, writable, _ = select.select([self._fd], wanted, [])
            if writable:
                sent += os.write(self._fd, data[sent : sent + 65536])
            if select.select([self._fd], [], [], 0)[0]:
                oks += self.answered()
        return time.perf_counter() - start


class Served:
    """`passo serve` with one console; use it with `with`."""

    def __init__(self, way: str, clock: str) -> None:
        self._folder = tempfile.TemporaryDirectory()
        pty = f"{self._folder.name}/printer"
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        words = [sys.executable, "-m", "passo", "serve", "--machine", "i3", "--clock", clock]
        words += ["--http", "none"]
        words += ["--pty", pty] if way == "pty" else ["--tcp", f"127.0.0.1:{port}"]
        self.process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
        assert self.process.stderr is not None
        self.process.stderr.readline()
        if way == "pty":
            fd = os.open(pty, os.O_RDWR | os.O_NOCTTY)
            tty.setraw(fd)
        else:
            client = socket.create_connection(("127.0.0.1", port))
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            fd = client.detach()
        self.line = Line(fd)
        for text in ("G92 X100 Y100 Z0", "G91", "M204 P3000"):
            self.line.ask(text)

    def __enter__(self) -> Served:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.communicate()
        self._folder.cleanup()

    def cpu_s(self) -> float:
        """User and system time of the printer so far."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def moves(count: int, mm: float, feed: float) -> list[str]:
    """A circle of such lines, relative."""
    return [
        f"G1 X{mm * math.cos(i / 50):.4f} Y{mm * math.sin(i / 50):.4f} F{feed:g}"
        for i in range(count)
    ]


def percentiles(answer: Callable[[str], float], lines: list[str], pace_s: float) -> str:
    """Of the seconds that lines, sent at a pace, wait for their `ok`."""
    taken: list[float] = []
    start = time.perf_counter()
    for i, line in enumerate(lines):
        if pace_s:
            time.sleep(max(0.0, start + i * pace_s - time.perf_counter()))
        taken.append(answer(line))
    cuts = statistics.quantiles(taken, n=100)
    return f"median {cuts[49] * 1e6:.0f}, 90 % {cuts[89] * 1e6:.0f}, 99 % {cuts[98] * 1e6:.0f}"


def echo(pace_s: float) -> str:
    """Of a bare pty."""
    master, slave = os.openpty()
    tty.setraw(slave)
    process = subprocess.Popen([sys.executable, "-c", ECHO, str(master)], pass_fds=[master])
    try:
        return percentiles(Line(slave).ask, ["G1 X1.0000 Y1.0000 F6000"] * ROUNDS, pace_s)
    finally:
        process.kill()
        process.wait()


def latency(way: str, pace_s: float) -> str:
    """Of a G1 into a queue that is neither empty nor full."""
    with Served(way, "real") as printer:
        mm = 100 * max(pace_s, 0.001)
        printer.line.pour(moves(30, mm, 6000))
        return percentiles(printer.line.ask, moves(ROUNDS, mm, 6000), pace_s)


def main() -> None:
    """Prints the figures."""
    for pace_s, when in ((0.0, "after the last ok"), (PACE_S, f"every {PACE_S * 1e3:g} ms")):
        print(f"ok of a line {when}, us: bare pty echo: {echo(pace_s)}")
        for way in ("pty", "tcp"):
            print(f"ok of a line {when}, us: G1 by {way}: {latency(way, pace_s)}")
    for way in ("pty", "tcp"):
        with Served(way, "real") as printer:
            taken = printer.line.pour(moves(1500, 0.1, 6000))
            print(f"into an empty queue by {way}: {1500 / taken:.0f} lines/s")
        with Served(way, "fast") as printer:
            taken = printer.line.pour(moves(LINES, 0.1, 6000))
            print(f"moves as fast as they go by {way}: {LINES / taken:.0f} lines/s")
            taken = printer.line.pour(["M105"] * LINES)
            print(f"M105 as fast as they go by {way}: {LINES / taken:.0f} lines/s")
        with Served(way, "real") as printer:
            printer.line.pour(moves(1500, 0.1, 6000))
            before, start = printer.cpu_s(), time.perf_counter()
            count = int(MOVING_S * 1000)
            printer.line.pour(moves(count, 0.1, 6000))
            wall = time.perf_counter() - start
            share = (printer.cpu_s() - before) / wall
            print(
                f"printing {count / wall:.0f} moves/s by {way}: {share:.0%} of a CPU, with the"
                " simulated board"
            )


if __name__ == "__main__":
    main()
