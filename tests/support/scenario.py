"""A printer in virtual time with a host that reads and writes lines: `send`, `expect`, `within`,
`fault`."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Callable, Coroutine
from typing import Any, TypeVar

from passo import config
from passo.clock import VirtualLoop
from passo.config.machine import MachineConfig
from passo.console.session import Session
from passo.library.assembly import assembled
from passo.motion.motion_queue import either
from passo.printer.unfit_commands import NOTHING, Skips
from passo.simulator import SimulatedBoard

_T = TypeVar("_T")
LOOK_S = 0.01


class Host:
    """One console of the printer, and all lines that it has heard."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self.heard: list[str] = []
        self._read = 0
        self._rest = b""
        self._news = asyncio.Event()
        self.held = False
        self.session = scenario.run(self._open())

    async def _open(self) -> Session:
        return Session(self._scenario.printer.control, self)

    def write(self, text: bytes, *, dispensable: bool = False) -> None:
        *lines, self._rest = (self._rest + text).split(b"\n")
        self.heard += [line.decode() for line in lines]
        self._news.set()

    def hold(self, held: bool) -> None:
        self.held = held

    def send(self, *lines: str) -> Host:
        """Sends lines, all at once."""
        return self.send_bytes("".join(f"{line}\n" for line in lines).encode())

    def send_bytes(self, data: bytes) -> Host:
        async def receive() -> None:
            self.session.receive(data)

        self._scenario.run(receive())
        return self

    def expect(self, pattern: str, within: float = 10.0) -> str:
        """The next line, among those not yet read, in which the pattern occurs; `within` seconds of
        virtual time."""
        wanted = re.compile(pattern)

        def found() -> bool:
            for i in range(self._read, len(self.heard)):
                if wanted.search(self.heard[i]):
                    self._read = i + 1
                    return True
            return False

        before = self._read
        if not self._scenario.until(found, within, self._news):
            heard = [line for line in self.heard[before:] if line != "wait"]
            raise AssertionError(f"no {pattern!r} within {within} s in {heard}")
        return self.heard[self._read - 1]

    def ok(self, line: str, within: float = 10.0) -> list[str]:
        """Sends a line and waits for its `ok`; returns what came with it, the `ok` line last."""
        self._read = len(self.heard)
        start = self._read
        self.send(line)
        self.expect(r"^ok", within)
        return self.heard[start : self._read]

    def silent(self, seconds: float, pattern: str = "") -> None:
        """No line with the pattern comes in so many seconds."""
        start = len(self.heard)
        self._scenario.passes(seconds)
        assert not [x for x in self.heard[start:] if re.search(pattern, x)]


class Scenario:
    """A printer with consoles on a loop of its own, in virtual time unless another loop is given;
    close it (or use `with`)."""

    def __init__(
        self,
        machine: str | MachineConfig = "i3",
        *,
        free: bool = False,
        card: str | None = None,
        state: str | None = None,
        reports: str | None = None,
        skips: Skips = NOTHING,
        loop: asyncio.AbstractEventLoop | None = None,
    ) -> None:
        self.loop = loop or VirtualLoop()
        self._failures: list[object] = []
        self.loop.set_exception_handler(lambda _, context: self._failures.append(context))
        self.machine = config.load(machine) if isinstance(machine, str) else machine
        try:
            self.printer = self.run(
                self._start(free=free, card=card, state=state, reports=reports, skips=skips)
            )
        except BaseException:
            self.loop.close()
            raise
        self._task = self.loop.create_task(self.printer.run())
        self.host = Host(self)

    async def _start(self, **options: Any) -> Any:
        self.assembly = assembled(self.machine, **options)
        return self.assembly.printer

    def __enter__(self) -> Scenario:
        return self

    def __exit__(self, *_: object) -> None:
        self.run(self._end())
        try:
            self.printer.close()
        finally:
            self.loop.close()
        assert not self._failures, self._failures

    async def _end(self) -> None:
        tasks = asyncio.all_tasks() - {asyncio.current_task()}
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    @property
    def board(self) -> SimulatedBoard:
        """The simulated board: its motors, bodies, and the faults that can be put on it."""
        return self.printer.board

    def run(self, coroutine: Coroutine[Any, Any, _T]) -> _T:
        return self.loop.run_until_complete(coroutine)

    def passes(self, seconds: float) -> None:
        """So much virtual time passes."""
        self._raise_failure()
        self.run(asyncio.sleep(seconds))

    def until(
        self, condition: Callable[[], bool], within: float, news: asyncio.Event | None = None
    ) -> bool:
        """Lets virtual time pass until the condition holds; False if it never did. Looks every
        10 ms, and with `news` only after it was set."""

        async def wait() -> bool:
            start = self.loop.time()
            end = start + within
            while not condition():
                left = end - self.loop.time()
                if left < 1e-9:  # rounding must not make it another look later
                    return False
                if news is None:
                    await asyncio.sleep(min(LOOK_S, left))
                else:
                    news.clear()
                    await either(news, left)
                    rest = LOOK_S - (self.loop.time() - start) % LOOK_S
                    await asyncio.sleep(max(0.0, min(rest, end - self.loop.time())))
            return True

        self._raise_failure()
        return self.run(wait())

    def _raise_failure(self) -> None:
        if self._task.done():
            self._task.result()

    def positions(self) -> dict[str, float]:
        """Where the mechanics are: actuator positions, mm or degrees."""
        return {s.name: round(self.board.position(s.name), 4) for s in self.board.board.steppers}
