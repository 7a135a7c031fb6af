"""A printer as the hub sees it, without motion, and the link to it, in virtual time.

What happens on the printer does not depend on the hub's connection: a request that has left the hub
may take effect though its answer is lost, or after a long time.
"""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any

from passo.hub.link import SILENT_S, Refused, RunReport, StartUnknown, Unreachable
from passo.printer.status import FaultStatus
from passo.web.summary import LastPrint, Summary, SummaryHeater, SummaryJob

ANSWER_S = 10.0  # the hub waits for an answer for this time
HOTEND_C = 210


@dataclass
class FakePrint:
    """A print that runs. It heats until filament moves."""

    path: str
    run: str
    begun_s: float
    heating: bool = True
    ends_s: float = 0.0
    timers: list[asyncio.TimerHandle] = field(default_factory=list)


@dataclass
class Start:
    """A start that took effect. `occupied`: the last print was still on the bed."""

    at_s: float
    run: str
    occupied: bool


class FakePrinter:
    """A printer that prints for `print_s` and heats for `heat_s` of it. `knows_runs` is False for a
    firmware that keeps no ids of runs; `clears_itself` for one that ejects a finished print."""

    def __init__(
        self,
        name: str,
        heat_s: float = 120.0,
        print_s: float = 1800.0,
        knows_runs: bool = True,
        clears_itself: bool = False,
    ) -> None:
        self.id, self.name = f"id-{name}", name
        self.heat_s, self.print_s = heat_s, print_s
        self.knows_runs, self.clears_itself = knows_runs, clears_itself
        self.state = "idle"
        self.job: FakePrint | None = None
        self.last: LastPrint | None = None
        self.fault: FaultStatus | None = None
        self.number = 0
        self.runs: dict[str, tuple[str, str, str]] = {}  # file, state, reason
        self.files: dict[str, str] = {}
        self.on_bed = False
        self.starts: list[Start] = []
        self.stops = self.cancels = 0
        self.users: list[str] = []
        self.lines: set[Callable[[], None]] = set()  # what ends a connection
        self.watchers: set[Callable[[Summary], None]] = set()
        self.reachable = True
        self.silent_since_s: float | None = None  # frozen: it neither answers nor closes
        self.begins: Callable[[FakePrinter], None] = lambda printer: None
        self.refuses_start = self.full = False

    @property
    def heating(self) -> bool:
        """Whether it takes its full power."""
        return self.job is not None and self.job.heating

    def summary(self) -> Summary:
        """What it reports now."""
        job, run = None, ""
        if self.job is not None:
            run = self.job.run if self.knows_runs else ""
            now_s = asyncio.get_running_loop().time()
            passed_s = now_s - self.job.begun_s
            mm = 0.0 if self.job.heating else max(passed_s - self.heat_s, 0.1)
            job = SummaryJob(self.job.path, run, 0.0, None, passed_s, 0, None, mm)
        target = HOTEND_C if self.job is not None else 0
        celsius = 20 if self.job is None or self.job.heating else HOTEND_C
        heaters = (SummaryHeater("hotend", celsius, target),)
        state: Any = self.state
        return Summary(self.id, self.name, "fake", state, job, self.last, heaters, self.fault)

    def start(self, run: str, path: str) -> None:
        """Starts a print, as the API of a printer does."""
        if self.knows_runs and run in self.runs:
            return
        if self.refuses_start or self.state != "idle" or path not in self.files:
            if self.knows_runs:
                self.runs[run] = (path, "failed", "the start was refused")
            raise Refused("command.busy", f"{self.name} is {self.state}", "Wait")
        if self.knows_runs:
            self.runs[run] = (path, "printing", "")
        self.starts.append(Start(asyncio.get_running_loop().time(), run, self.on_bed))
        self._begin(path, run)

    def print_by_hand(self, path: str = "/by hand.gcode") -> None:
        """A user starts a print at the printer itself."""
        if self.state == "idle":
            self._begin(path, "")

    def pause(self) -> None:
        """Pauses the print, which then never ends by itself."""
        if self.job is None or self.state != "printing":
            raise Refused("job.none", "Nothing prints", "Start a print")
        for timer in self.job.timers:
            timer.cancel()
        self.job.heating = False
        self.state = "paused"
        self._changed()

    def resume(self) -> None:
        """Resumes the print, which ends after its whole time."""
        if self.job is None or self.state != "paused":
            raise Refused("job.none", "Nothing is paused", "Start a print")
        self.state = "printing"
        loop = asyncio.get_running_loop()
        self.job.timers = [loop.call_later(self.print_s, self._end, "done", "")]
        self._changed()

    def cancel(self) -> None:
        """Cancels the print."""
        if self.job is None:
            raise Refused("job.none", "Nothing prints", "Start a print")
        self.cancels += 1
        self._end("cancelled", "")

    def halt(self, reason: str) -> None:
        """The printer halts by a fault, and its print fails."""
        self.state = "halted"
        self.fault = FaultStatus("heat.runaway", "hotend", reason, "Look at the heater")
        if self.job is not None:
            self._end("failed", reason)
        self._changed()

    def stop(self) -> None:
        """Emergency stop."""
        self.stops += 1
        self.halt("Emergency stop")

    def restart(self) -> None:
        """A user restarts it after a halt."""
        if self.state == "halted":
            self.state, self.fault = "idle", None
            self._changed()

    def power_cut(self) -> None:
        """The power fails for a moment: the print is lost, connections end."""
        self.disconnect()
        self.state, self.fault = "idle", None
        if self.job is not None:
            self._end("failed", "The power failed")

    def disconnect(self) -> None:
        """All connections end; new ones are possible if the printer is reachable."""
        for end in list(self.lines):
            end()

    def freeze(self) -> None:
        """The network swallows everything, until `thaw`. The hub notices it after a while."""
        loop = asyncio.get_running_loop()
        self.silent_since_s = since_s = loop.time()

        def notice() -> None:
            if self.silent_since_s == since_s:
                self.disconnect()

        loop.call_later(SILENT_S, notice)

    def thaw(self) -> None:
        """The network is back."""
        self.silent_since_s = None

    def _begin(self, path: str, run: str) -> None:
        loop = asyncio.get_running_loop()
        self.on_bed, self.state = True, "printing"
        self.number += 1
        self.job = FakePrint(path, run, loop.time(), ends_s=loop.time() + self.print_s)
        self.job.timers = [
            loop.call_later(self.heat_s, self._warm),
            loop.call_later(self.print_s, self._end, "done", ""),
        ]
        self.begins(self)
        self._changed()

    def _warm(self) -> None:
        assert self.job is not None
        self.job.heating = False
        self._changed()

    def _end(self, result: Any, reason: str) -> None:
        assert self.job is not None
        for timer in self.job.timers:
            timer.cancel()
        run = self.job.run if self.knows_runs else ""
        if run:
            self.runs[run] = (self.job.path, result, reason)
        if self.clears_itself and result == "done":
            self.on_bed = False
        self.last = LastPrint(self.number, self.job.path, run, result, reason)
        self.job = None
        if self.state != "halted":
            self.state = "idle"
        self._changed()

    def _changed(self) -> None:
        for watcher in list(self.watchers):
            watcher(self.summary())


@dataclass
class Network:
    """How the network misbehaves: parts of all requests that are lost before their effect, lose
    their answer after it, or take effect late."""

    lost: float = 0.0
    unanswered: float = 0.0
    late: float = 0.0
    late_s: float = 40.0
    delay_s: float = 0.05
    upload_s: float = 5.0
    connecting: int = 0  # connections that begin now, and the most of them so far
    most_connecting: int = 0


def sha256_of(path: Path) -> str:
    """The hash of a file, as a printer checks it."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


class FakeLink:
    """A `Link` to a fake printer. `called` is called before a request leaves the hub, and returns
    its number; `answered` is called with it after the effect, before the answer arrives."""

    def __init__(
        self,
        printer: FakePrinter,
        chance: Random,
        network: Network,
        called: Callable[[], int] = lambda: 0,
        answered: Callable[[int], None] = lambda number: None,
    ) -> None:
        self.printer, self._chance, self._network = printer, chance, network
        self._called, self._answered = called, answered

    async def follow(self, seen: Callable[[Summary], None]) -> None:
        loop = asyncio.get_running_loop()
        printer = self.printer
        await self._connect()
        ended: asyncio.Future[None] = loop.create_future()
        queue: asyncio.Queue[Summary] = asyncio.Queue()
        queue.put_nowait(printer.summary())

        def end() -> None:
            if not ended.done():
                ended.set_result(None)

        printer.lines.add(end)
        printer.watchers.add(queue.put_nowait)
        news = loop.create_task(self._deliver(queue, seen))
        try:
            while not ended.done():
                await asyncio.wait({ended, news}, timeout=None, return_when="FIRST_COMPLETED")
                if news.done():
                    news.result()
                    break
        finally:
            printer.lines.discard(end)
            printer.watchers.discard(queue.put_nowait)
            news.cancel()
        raise Unreachable("the connection has ended")

    async def _connect(self) -> None:
        network = self._network
        network.connecting += 1
        network.most_connecting = max(network.most_connecting, network.connecting)
        try:
            if not self.printer.reachable or self.printer.silent_since_s is not None:
                await asyncio.sleep(ANSWER_S)
                raise Unreachable("no connection")
            await asyncio.sleep(network.delay_s)
        finally:
            network.connecting -= 1

    async def _deliver(
        self, queue: asyncio.Queue[Summary], seen: Callable[[Summary], None]
    ) -> None:
        while True:
            summary = await queue.get()
            await asyncio.sleep(self._network.delay_s)
            if self.printer.silent_since_s is not None:
                return
            seen(summary)

    async def upload(self, content: Path, name: str, sha256: str) -> str:
        path = f"/{sha256[:8]}-{name}"

        def effect() -> str:
            if sha256_of(content) != sha256:
                raise Refused("upload.checksum", "The file has another hash", "Send it again")
            if self.printer.full:
                raise Refused("card.full", "The card is full", "Delete files")
            self.printer.files[path] = sha256
            return path

        return await self._request(effect, self._network.upload_s)

    async def start(self, run: str, path: str, user: str) -> None:
        self.printer.users.append(user)
        await self._request(lambda: self.printer.start(run, path))

    async def report(self, run: str) -> RunReport | None:
        def effect() -> RunReport | None:
            if not self.printer.knows_runs:
                raise StartUnknown(f"{self.printer.name} keeps no ids of runs")
            found = self.printer.runs.get(run)
            if found is None:
                return None
            paused = found[1] == "printing" and self.printer.state == "paused"
            return RunReport("paused" if paused else found[1], found[2])

        return await self._request(effect)

    async def pause(self, user: str) -> None:
        self.printer.users.append(user)
        await self._request(self.printer.pause)

    async def resume(self, user: str) -> None:
        self.printer.users.append(user)
        await self._request(self.printer.resume)

    async def cancel(self, user: str) -> None:
        self.printer.users.append(user)
        await self._request(self.printer.cancel)

    async def stop(self, user: str) -> None:
        self.printer.users.append(user)
        await self._request(self.printer.stop)

    async def machine(self) -> str:
        return ""

    async def picture(self, path: str) -> bytes:
        return b""

    async def close(self) -> None:
        pass

    async def _request(self, effect: Callable[[], Any], takes_s: float = 0.0) -> Any:
        number = self._called()
        loop = asyncio.get_running_loop()
        answer: asyncio.Future[Any] = loop.create_future()
        fate, network = self._chance.random(), self._network
        lost = fate < network.lost
        late = not lost and fate < network.lost + network.late
        unanswered = fate < network.lost + network.late + network.unanswered

        def arrive() -> None:
            if not self.printer.reachable:
                return
            if self.printer.silent_since_s is not None:
                loop.call_later(1.0, arrive)  # it waits in a buffer of the printer's computer
                return
            try:
                result: Any = effect()
            except (Refused, StartUnknown) as error:
                result = error
            self._answered(number)
            if not unanswered and not answer.done():
                if isinstance(result, Exception):
                    answer.set_exception(result)
                    answer.exception()  # the hub may not wait for it any more
                else:
                    answer.set_result(result)

        if not lost:
            after_s = network.delay_s + takes_s + (network.late_s if late else 0.0)
            loop.call_later(after_s, arrive)
        try:
            return await asyncio.wait_for(answer, ANSWER_S + takes_s)
        except TimeoutError:
            raise Unreachable("no answer") from None


assert ANSWER_S < SILENT_S
