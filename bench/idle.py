"""What idle printers cost. Usage: bench/idle.py [MACHINE] [--seconds N] [--counts 1,4,16] [--python
PROGRAM]

Starts 1, 4 and then 16 processes of `passo serve --simulated`, each with its web interface and a
TCP console that no client opens, and waits until all listen. Prints for each number the means of
one printer: CPU from the start until it listens, CPU while idle in percent of one core, wake-ups of
the process per second, and its memory: RSS, PSS (shared pages divided among their users) and
private. --python measures the passo of another environment. The times are CPU times, which other
load on the computer changes less than wall times. As in an installation, Python finds its modules
compiled: a first printer, which is not measured, fills a cache."""

from __future__ import annotations

import argparse
import os
import re
import select
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Self

_TICKS_HZ = os.sysconf("SC_CLK_TCK")
_SETTLE_S = 5.0
_START_S = 300.0  # until all listen, also on a busy computer
_MB = 1e3  # kB


@dataclass(frozen=True)
class _Sample:
    """What one process has used up to now."""

    at_s: float
    cpu_s: float
    wakeups: int

    @classmethod
    def of(cls, pid: int) -> Self:
        """Reads it: with the threads that it has now."""
        wakeups = 0
        for status in Path(f"/proc/{pid}/task").glob("*/status"):
            wakeups += int(_field(status.read_text(), "voluntary_ctxt_switches"))
        return cls(time.monotonic(), _cpu_s(pid), wakeups)


class _Served:
    """One served printer."""

    def __init__(self, python: str, machine: str, cache: str, number: int) -> None:
        words = [python, "-m", "passo", "serve", "--machine", machine, "--simulated"]
        words += ["--tcp", f"127.0.0.1:{23_000 + number}", "--http", f"127.0.0.1:{24_000 + number}"]
        environment = {**os.environ, "PYTHONPYCACHEPREFIX": cache}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        self._process = subprocess.Popen(words, stderr=subprocess.PIPE, env=environment)
        self.pid = self._process.pid

    def until_listening(self, end_s: float) -> float:
        """Waits until it listens; returns the CPU that it has used, s. Raises SystemExit."""
        assert self._process.stderr is not None
        os.set_blocking(self._process.stderr.fileno(), False)
        text = b""
        while b"Serving " not in text:
            ready, _, _ = select.select(
                [self._process.stderr], [], [], max(0, end_s - time.monotonic())
            )
            piece = self._process.stderr.read() if ready else b""
            if not piece:
                raise SystemExit(f"no printer after {_START_S:.0f} s: {text.decode()}")
            text += piece
        return _cpu_s(self.pid)

    def memory_mb(self) -> tuple[float, float, float]:
        """RSS, PSS and private."""
        text = Path(f"/proc/{self.pid}/smaps_rollup").read_text()
        private = int(_field(text, "Private_Clean")) + int(_field(text, "Private_Dirty"))
        return int(_field(text, "Rss")) / _MB, int(_field(text, "Pss")) / _MB, private / _MB

    def close(self) -> None:
        """Ends it."""
        self._process.send_signal(signal.SIGTERM)
        try:
            self._process.wait(30)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


def _field(text: str, name: str) -> str:
    found = re.search(rf"^{name}:\s+(\d+)", text, re.MULTILINE)
    assert found is not None
    return found[1]


def _cpu_s(pid: int) -> float:
    """User and system CPU of a process, from the nanoseconds of its threads' schedules if the
    kernel counts them, else from its clock ticks."""
    total = 0
    for schedule in Path(f"/proc/{pid}/task").glob("*/schedstat"):
        total += int(schedule.read_text().split()[0])
    if total:
        return total / 1e9
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICKS_HZ


def compile_modules(python: str, machine: str, cache: str) -> None:
    """Fills the cache of compiled modules."""
    first = _Served(python, machine, cache, 0)
    first.until_listening(time.monotonic() + _START_S)
    time.sleep(_SETTLE_S)
    first.close()


def measure(python: str, machine: str, cache: str, count: int, seconds: float) -> str:
    """A row of the table."""
    printers: list[_Served] = []
    try:
        printers.extend(_Served(python, machine, cache, number) for number in range(count))
        end_s = time.monotonic() + _START_S
        # In the order of the start; later ones listen meanwhile, so their figure is an upper bound.
        starts_s = [printer.until_listening(end_s) for printer in printers]
        time.sleep(_SETTLE_S)
        before = [_Sample.of(printer.pid) for printer in printers]
        time.sleep(seconds)
        after = [_Sample.of(printer.pid) for printer in printers]
        memory = [printer.memory_mb() for printer in printers]
    finally:
        for printer in printers:
            printer.close()
    idle: list[float] = []
    wakeups: list[float] = []
    for a, b in zip(before, after, strict=True):
        idle.append(100 * (b.cpu_s - a.cpu_s) / (b.at_s - a.at_s))
        wakeups.append((b.wakeups - a.wakeups) / (b.at_s - a.at_s))
    rss, pss, private = (statistics.mean(column) for column in zip(*memory, strict=True))
    return (
        f"{count:8}{statistics.mean(starts_s):9.2f}{statistics.mean(idle):8.2f}"
        f"{statistics.mean(wakeups):12.1f}{rss:8.1f}{pss:8.1f}{private:11.1f}"
    )


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("machine", nargs="?", default="i3")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--counts", default="1,4,16")
    parser.add_argument("--python", default=sys.executable)
    arguments = parser.parse_args()
    print(f"idle printers, {arguments.machine}, {arguments.seconds:.0f} s")
    print("printers  start s  idle %  wake-ups/s  RSS MB  PSS MB  private MB")
    what = arguments.python, arguments.machine
    with tempfile.TemporaryDirectory() as cache:
        compile_modules(*what, cache)
        for count in map(int, arguments.counts.split(",")):
            print(measure(*what, cache, count, arguments.seconds), flush=True)


if __name__ == "__main__":
    main()
