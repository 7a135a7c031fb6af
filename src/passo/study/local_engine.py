"""Computes shards in processes of this computer. Each lane is a pool of one process, so that a
crash or a timeout ends one process, and names its shard.

| event | what the engine does |
|---|---|
| a process dies, or a shard takes too long | ends the process; each case runs again, alone |
| a case alone dies | its result is `crash` |
| a case alone takes too long | its result is `timeout` |
| this process dies | the processes end |
"""

from __future__ import annotations

import multiprocessing
import os
import resource
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Generator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.process import BaseProcess

from passo.errors import MachineError, Problem
from passo.study.engine import Done
from passo.study.work import Compute, Result, Shard, compute, failure, load_figures, split

TIMEOUT_S = 300.0
"""The time that a case may take, s."""
MEMORY_MB = 4096
"""The memory that a process may use, MB."""
_LOOK_S = 0.2  # interval of the checks for shards that take too long
_START_S = 120.0  # a process that takes longer to start, on a busy computer, is stuck
_MAX_FAILED_STARTS = 3
_MAX_LOOKS = 1000


@dataclass(slots=True)
class _Running:
    shard: Shard
    alone: bool
    future: Future[list[Result]]
    until_s: float
    timed: bool  # whether its process has started, so that the time of the shard counts


class _Lane:
    """A pool of one process."""

    def __init__(self, compute: Compute, memory_mb: int) -> None:
        self._compute = compute
        # New processes, because the caller may have threads.
        context = multiprocessing.get_context("spawn")
        self._pool = ProcessPoolExecutor(1, context, _begin, (memory_mb,))
        others = set(multiprocessing.active_children())
        with _interrupts_blocked():
            self._pid = self._pool.submit(os.getpid)
        self._processes = set(multiprocessing.active_children()) - others
        self.running: _Running | None = None

    @property
    def started(self) -> bool:
        """Whether its process has started."""
        return self._pid.done() and self._pid.exception() is None

    def submit(self, shard: Shard, until_s: float, *, alone: bool) -> None:
        """Computes a shard. Raises BrokenProcessPool if its process has died."""
        future = self._pool.submit(self._compute, shard)
        self.running = _Running(shard, alone, future, until_s, timed=False)

    def end(self) -> str:
        """Kills its process, if it lives, also one that is stopped by SIGSTOP. Returns the signal
        that ended the process, or its exit status."""
        for process in self._processes:
            process.kill()
        self._pool.shutdown(wait=False, cancel_futures=True)
        codes = [code for p in self._processes if (code := _exit_code(p)) is not None]
        if not codes:
            return "an unknown signal"
        return signal.Signals(-codes[0]).name if codes[0] < 0 else f"exit status {codes[0]}"


class LocalEngine:
    """Computes on `jobs` processes. A case has `timeout_s`; a process has `memory_mb`."""

    shard_s = 1.0

    def __init__(
        self,
        jobs: int,
        timeout_s: float = TIMEOUT_S,
        memory_mb: int = MEMORY_MB,
        compute: Compute = compute,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self.workers = jobs
        self._timeout_s, self._memory_mb = timeout_s, memory_mb
        self._compute, self._now = compute, now
        self._lanes: list[_Lane | None] = [None] * jobs
        self._waiting: deque[tuple[Shard, bool]] = deque()  # with whether it is alone
        self._failed_starts = 0

    @property
    def free(self) -> bool:
        """Whether a process has no shard."""
        return not self._waiting and any(self._idle(lane) for lane in self._lanes)

    @property
    def busy(self) -> bool:
        """Whether there are shards without results."""
        return bool(self._waiting) or not all(self._idle(lane) for lane in self._lanes)

    def submit(self, shard: Shard) -> None:
        """Takes a shard."""
        self._waiting.append((shard, False))
        self._start()

    def completed(self) -> list[Done]:
        """Waits until shards are done or for a moment, and returns those that are done. Raises
        MachineError if no process can be started."""
        self._start()
        futures = [lane.running.future for lane in self._lanes if lane and lane.running]
        wait(futures, _LOOK_S, FIRST_COMPLETED)
        done: list[Done] = []
        for i, lane in enumerate(self._lanes):
            if lane is not None and lane.running is not None:
                done += self._look(i, lane, lane.running)
        return done

    def close(self) -> None:
        """Ends the processes."""
        for lane in self._lanes:
            if lane is not None:
                lane.end()
        self._lanes = [None] * len(self._lanes)
        self._waiting.clear()

    @staticmethod
    def _idle(lane: _Lane | None) -> bool:
        return lane is None or lane.running is None

    def _start(self) -> None:
        """Gives waiting shards to idle lanes."""
        for i, lane in enumerate(self._lanes):
            if not self._waiting:
                return
            if lane is None:
                lane = self._lanes[i] = _Lane(self._compute, self._memory_mb)
            if lane.running is None:
                shard, alone = self._waiting.popleft()
                try:
                    lane.submit(shard, self._now() + _START_S, alone=alone)
                except BrokenProcessPool:  # it died while it was idle
                    lane.end()
                    self._lanes[i] = None
                    self._waiting.appendleft((shard, alone))

    def _look(self, i: int, lane: _Lane, running: _Running) -> list[Done]:
        """The results of a lane, if it has some."""
        if lane.started and not running.timed:
            running.until_s, running.timed = self._now() + self._timeout_s, True
            self._failed_starts = 0
        if running.future.done():
            error = running.future.exception()
            if error is None:
                lane.running = None
                return [Done(running.shard, running.future.result())]
            if not isinstance(error, BrokenProcessPool):
                raise error
            return self._lost(i, lane, running, "crash")
        if self._now() > running.until_s:
            return self._lost(i, lane, running, "timeout")
        return []

    def _lost(self, i: int, lane: _Lane, running: _Running, status: str) -> list[Done]:
        """Ends a lane whose shard has no results, and computes its cases alone."""
        how = lane.end()
        self._lanes[i] = None
        if not running.timed:
            self._failed_starts += 1
            if self._failed_starts >= _MAX_FAILED_STARTS:
                raise MachineError.of("study.no-process", value=how)
            self._waiting.appendleft((running.shard, running.alone))
            return []
        if not running.alone:
            self._waiting.extend((single, True) for single in split(running.shard))
            return []
        value = how if status == "crash" else f"{self._timeout_s:g}"
        problem = Problem(f"study.{status}", values={"value": value})
        return [Done(running.shard, [failure(status, problem)])]


def _exit_code(process: BaseProcess) -> int | None:
    """The exit code of a process that has ended or was killed."""
    for _ in range(_MAX_LOOKS):
        process.join(_LOOK_S)
        if process.exitcode is not None:  # the pool may just be reading it, in its own thread
            return process.exitcode
    return None


@contextmanager
def _interrupts_blocked() -> Generator[None]:
    """Processes that start here never receive Ctrl-C: this process ends them."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin(memory_mb: int) -> None:
    """Starts a process of a lane: limits its memory, and ends it when its parent dies."""
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    wanted = memory_mb << 20
    limit = wanted if most == resource.RLIM_INFINITY else min(wanted, most)
    resource.setrlimit(resource.RLIMIT_AS, (limit, most))
    threading.Thread(target=_end_with_parent, daemon=True).start()
    load_figures()  # so that the time of the first case is its own


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
