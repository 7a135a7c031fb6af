"""Live printers as a library: commands, prints, status and events, within an event loop."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import time
from collections.abc import AsyncGenerator, Awaitable, Callable, Collection, Coroutine
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Literal, Self, TypeVar

from passo import config
from passo.board.fault_injection import FaultOrder
from passo.board.faults import HeaterFault
from passo.card.local import local_uri
from passo.clock import new_loop
from passo.console.client import Client, Reply
from passo.console.printer_console import welcome
from passo.console.session import Session, Wire
from passo.errors import CommandError, InputError, MachineError
from passo.gcode.command import Command, Given
from passo.job.printer_id import printer_id
from passo.library.assembly import Assembly, assembled
from passo.library.machine import Machine
from passo.printer.setup.connections import with_reported_clocks
from passo.printer.unfit_commands import Skips
from passo.services.observer import Observer
from passo.version import __version__

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.console.transports.streams import Console, NewSession
    from passo.events import Event
    from passo.job.live.job_state import JobState
    from passo.library.bridge import LiveBridge
    from passo.printer import printer as printers
    from passo.printer.status import Status
    from passo.web.accounts.accounts import Accounts
    from passo.web.server import WebThread
    from passo.web.temperature_history import TemperatureHistory

_log = logging.getLogger(__name__)

_T = TypeVar("_T")
_MAX_EVENTS = 10_000  # maximum of events that wait for a slow reader


@dataclass(frozen=True, slots=True)
class PrintSummary:
    """A finished print from a file: its print time without pauses, and the filament of all
    extruders together."""

    file: str
    outcome: Literal["done", "cancelled"]
    print_s: float
    filament_mm: float


def run(main: Coroutine[Any, Any, _T], *, clock: Literal["real", "virtual"] | float = "real") -> _T:
    """Runs a coroutine like `asyncio.run`, with its own clock. `clock` is `real`, `virtual` (every
    wait ends at once, and each run is the same), or a factor of the speed of real time. All
    printers that `main` opens share that time. Boards that are not simulated need `real`.
    """
    scale = 1.0 if clock == "real" else None if clock == "virtual" else float(clock)
    with asyncio.Runner(loop_factory=lambda: new_loop(scale)) as runner:
        return runner.run(main)


class Printer:
    """A live printer, as `passo serve` runs it: open it with `async with`.

    At the end of the block, heaters and laser are switched off, and the board is released. All
    methods belong to one event loop; any number of printers may share it.
    """

    def __init__(
        self,
        machine: Machine | MachineConfig | str | os.PathLike[str],
        *,
        fast: bool = False,
        card: str | None = None,
        state: str | None = None,
        halt_reports: str | None = None,
        skip_unknown: bool = False,
        skip_levelling: bool = False,
        clamp: bool = False,
        ignore_tools: bool = False,
        machine_source: str = "",
        restarts: bool = False,
    ) -> None:
        """`machine` is a machine, or the name or file of one. With `fast`, the print time of a
        simulated board passes as fast as possible, but only while a task waits for it. `card` is
        the SD card (a folder, an image or a device). `state` is the folder of settings, history,
        the journal and a report of each halt; without it, `halt_reports` is the prefix of the paths
        of the reports, if given. `skip_unknown` and `skip_levelling` let prints skip commands, see
        `Machine.print`; `clamp` and `ignore_tools` are those of `Machine.estimate`.
        `machine_source` is the file that a given machine was loaded from. With `restarts` the web
        may end the printer to restart it, see `serve`. Raises ConfigError."""
        self._source = machine_source
        if isinstance(machine, str | os.PathLike):
            self._source = os.fspath(machine)
            machine = config.load(machine)
        self._restarts, self._restart_wanted = restarts, False
        self.config = machine.config if isinstance(machine, Machine) else machine
        self._fast, self._card, self._state = fast, card, state
        self._halt_reports = halt_reports
        self._skips = Skips(skip_unknown, skip_levelling, clamp, ignore_tools)
        self._assembly: Assembly | None = None
        self.id = ""  # the id of the printer, a UUID, while it is open
        self._observed: Observer | None = None
        self._client: Client | None = None
        self._bridged: LiveBridge | None = None
        self._places: list[str] = []  # addresses for hosts, browsers and Moonraker
        self._web: WebThread | None = None
        self._opened_accounts: Accounts | None = None
        self._kept_temperatures: TemperatureHistory | None = None
        self._serving: asyncio.Task[None] | None = None
        self._prints: set[asyncio.Future[None]] = set()
        self._queues: set[asyncio.Queue[Event | None]] = set()

    async def __aenter__(self) -> Self:
        """Connects to the boards and starts. Raises MachineError, CardError, InputError."""
        self.config = with_reported_clocks(self.config)
        self._assembly = assembled(
            self.config,
            free=self._fast,
            card=self._card,
            state=self._state,
            reports=self._halt_reports,
            skips=self._skips,
            source=self._source,
            restart=self._restart if self._restarts else None,
        )
        self.id = printer_id(None if self._state is None else Path(self._state))
        _log.info("Printer %s started by Passo %s", self.config.name, __version__)
        self._serving = asyncio.create_task(self._printer.run())
        self._serving.add_done_callback(self._ended)
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Ends all waits, switches heaters and laser off and releases the boards."""
        assert self._serving is not None
        with contextlib.closing(self._printer):
            if self._observed is not None:
                self._observed.close()
            if self._web is not None:
                await asyncio.to_thread(self._web.close)
            if self._opened_accounts is not None:
                self._opened_accounts.close()
            if self._bridged is not None:
                self._bridged.close()
            if self._client is not None:
                self._client.close()
            self._serving.cancel()
            await asyncio.wait([self._serving])
        self._assembly = None
        _log.info("Printer %s closed", self.config.name)
        if error is None and not self._serving.cancelled():
            self._serving.result()

    # -- what it does -----------------------------------------------------------------------------

    async def send(self, line: str) -> Reply:
        """Executes one line of G-code and returns its answer. The answer to a move comes when the
        move is planned; `M400` waits until the machine is at standstill. Raises CommandError if the
        line is refused, and ValueError for more than one line. If the calling task is cancelled, a
        line that has not started is dropped, and a wait ends as with M108; planned moves are still
        executed.
        """
        return await self._console().send(line)

    async def call(self, code: str, **given: Given) -> Reply:
        """As `send`, for a command with values, by letter or key: `call("M106", P=0, S=128)`. True
        is a letter alone; False and None are not given."""
        return await self._console().execute(Command.call(code, **given))

    def _console(self) -> Client:
        self._raise_if_ended()
        if self._client is None:
            self._client = Client(self._printer.control)
        return self._client

    async def print(self, path: str | os.PathLike[str]) -> PrintSummary:
        """Prints a file of this computer, and returns after the last move or the cancellation of
        the print. It keeps waiting during a pause.

        If the calling task is cancelled, the print is cancelled, too: the machine brakes, and
        heaters and fans go off. Raises InputError for a file that cannot be read, CommandError
        during another print, and CommandError or MachineError when the print fails. After a failed
        line, heaters keep their targets, so that `resume` can continue after the line.
        """
        self._raise_if_ended()
        jobs, printer = self._opened.services.jobs, self._printer
        runner = jobs.runner
        jobs.files.open(local_uri(path))
        before_mm = printer.suspension.filament_mm()
        over: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        begun = False

        def watch(_: JobState, __: JobState) -> None:
            nonlocal begun
            begun = begun or runner.active
            if begun and not (runner.active or over.done()):
                over.set_result(None)

        runner.watchers.append(watch)
        self._prints.add(over)
        try:
            runner.start()
            await over
        except asyncio.CancelledError:
            runner.cancel()
            raise
        finally:
            self._prints.discard(over)
            runner.watchers.remove(watch)
        if runner.ended == "failed":
            if runner.problems:
                raise CommandError(runner.problems)
            faults = [
                HeaterFault.of(name, heater.fault).problem
                for name, heater in printer.rig.connection.heaters.items()
                if heater.fault is not None
            ]
            if faults:
                raise MachineError(faults)
            raise MachineError.of("job.stopped", os.fspath(path), value=runner.failed)
        return PrintSummary(
            os.fspath(path),
            "cancelled" if runner.ended == "cancelled" else "done",
            jobs.progress.printed_s,
            printer.suspension.filament_mm() - before_mm,
        )

    async def pause(self) -> None:
        """Pauses the print from a file (M25): the machine brakes and parks."""
        await self.call("M25")

    async def resume(self) -> None:
        """Ends a pause, or continues after a line that failed (M24). Raises CommandError."""
        await self.call("M24")

    async def cancel(self) -> None:
        """Cancels the print from a file (M524): the machine brakes, heaters and fans go off."""
        await self.call("M524")

    @property
    def faults(self) -> dict[str, tuple[str, ...]]:
        """The faults that each part of a simulated printer can have, by the part's name; empty for
        real boards."""
        injector = self._printer.rig.connection.injector
        return {} if injector is None else dict(injector.values)

    def inject_fault(
        self, part: str, value: str, *, after_s: float = 0.0, for_s: float | None = None
    ) -> None:
        """Gives a part of the simulated printer a fault `after_s` seconds of print time from now,
        for `for_s` seconds or permanently; the fault `none` ends one
        (docs/how-to/simulate-faults.md). Raises CommandError for a part or a fault that does not
        exist, and for real boards."""
        self._printer.faults.order(FaultOrder(part, value, after_s, for_s))

    # -- reports --------------------------------------------------------------------------

    @property
    def status(self) -> Status:
        """The status of the printer now."""
        return self._printer.status.read()

    @property
    def time_s(self) -> float:
        """Print time since the start or the last restart (M999), seconds."""
        return max(self._printer.rig.queue.now_s, 0.0)

    @property
    def start_messages(self) -> tuple[str, ...]:
        """The messages of the start that no console has shown so far, and the reason if the printer
        is halted."""
        printer = self._printer
        halted = (f"Printer halted: {printer.state.why_halted}",) if printer.state.halted else ()
        return (*printer.state.unreported, *halted)

    def show_message(self, text: str) -> None:
        """Shows a line on all consoles."""
        self._printer.state.tell(f"echo:{text}")

    def on_status(
        self, call: Callable[[Status], object], *, every_s: float = 1.0
    ) -> Callable[[], None]:
        """Calls `call` with the status now, and then every `every_s` seconds (at least 0.25 s) of
        host time, or of print time if that runs faster. Returns a function that ends the calls."""
        return self._observer.on_status(call, every_s)

    def on_event(self, call: Callable[[Event], object]) -> Callable[[], None]:
        """Calls `call` with each event from now on: see `passo.events`. Returns a function that
        ends the calls."""
        return self._observer.on_event(call)

    async def events(self) -> AsyncGenerator[Event]:
        """The events from now on, until the printer is closed. If more than 10000 wait for the
        reader, the oldest are dropped."""
        queue: asyncio.Queue[Event | None] = asyncio.Queue()

        def put(event: Event) -> None:
            if queue.qsize() >= _MAX_EVENTS:
                queue.get_nowait()
            queue.put_nowait(event)

        end = self.on_event(put)
        self._queues.add(queue)
        try:
            while (event := await queue.get()) is not None:
                yield event
        finally:
            self._queues.discard(queue)
            end()

    # -- consoles for hosts -----------------------------------------------------------------------

    async def open_tcp(
        self, host: str = "127.0.0.1", port: int = 0, *, clients: int = 2, advanced_ok: bool = False
    ) -> str:
        """Opens a TCP console for at most `clients` clients at once; port 0 is any free port.
        Returns `tcp HOST:PORT`. Raises ConsoleError."""
        from passo.console.transports.streams import open_tcp

        new_session = self._new_session(advanced_ok=advanced_ok)
        return await self._add(open_tcp(new_session, host, port, clients))

    async def open_pty(self, path: str, *, advanced_ok: bool = False) -> str:
        """Opens a pseudo terminal; `path` becomes a link to it. Raises ConsoleError."""
        from passo.console.transports.serial import open_pty

        return await self._add(open_pty(self._new_session(advanced_ok=advanced_ok), path))

    async def open_serial(self, device: str, baud: int, *, advanced_ok: bool = False) -> str:
        """Opens a serial device as a console. Raises ConsoleError."""
        from passo.console.transports.serial import open_serial

        new_session = self._new_session(advanced_ok=advanced_ok)
        return await self._add(open_serial(new_session, device, baud))

    async def open_stdin(self, over: Callable[[], None], *, advanced_ok: bool = False) -> str:
        """Opens standard input and output as a console; `over` is called when the input has ended
        and its last line is executed. Raises ConsoleError."""
        from passo.console.transports.streams import open_stdin

        return await self._add(open_stdin(self._new_session(advanced_ok=advanced_ok), over))

    def open_http(
        self,
        host: str = "127.0.0.1",
        port: int = 0,
        *,
        path: str | os.PathLike[str] | None = None,
        names: Collection[str] = (),
        log: str | None = None,
        announce: bool = False,
    ) -> str:
        """Serves the web interface, in a thread of its own; port 0 is any free port; `path` is a
        Unix socket in place of host and port, for its user and group; `names` are the host names
        that clients may use for it; `log` is a log file that may be downloaded. With `announce`,
        multicast DNS announces it in the local network. Accounts are kept in the folder `state`,
        else in memory (docs/explanation/security.md). Returns `http://HOST:PORT` or `unix:PATH`.
        Needs the extra `passo[web]`, and `passo[mdns]` to announce; raises InputError if the
        address cannot be opened or announced, WebError if the accounts cannot be used, and
        ImportError without the extras."""
        from passo.web import listening
        from passo.web.app import web_app
        from passo.web.logs import Logs

        if announce and path is not None:
            raise InputError.of("web.announce-loopback", value=path)
        opened = listening.tcp(host, port) if path is None else listening.unix(path)
        stems = [Path(stem) for stem in (log, self._halt_reports) if stem]
        if self._state is not None:
            stems.append(Path(self._state) / "halt")
        known = frozenset(name.lower() for name in names)
        try:
            announced = None
            if announce:
                from passo.web.announcement import Announcement

                announced = Announcement(self.config.name, opened.host, opened.port, self.id)
                known |= {announced.host_name}
            state = None if self._state is None else Path(self._state)
            kept = self._accounts, opened.binding(known), self._temperatures, Logs(stems)
            app = web_app(self._bridge, *kept, printer_id=self.id, state=state)
        except BaseException:
            opened.close()
            raise
        self._web_thread.serve(app, opened.socket, opened.remove)
        if announced is not None:
            self._web_thread.start(announced.run(), endless=True)
        self._places.append(opened.place)
        return self._places[-1]

    @property
    def one_time_code(self) -> str:
        """The code with which another computer creates the administrator of the web interface.
        Empty if the administrator exists, or if no web interface is open."""
        return "" if self._opened_accounts is None else self._opened_accounts.code

    def open_klippy(self, path: str, *, log_file: str | None = None) -> str:
        """Serves Klipper's API on a Unix socket that only this user may open, for Moonraker.
        `log_file` is the file that clients show as its log. Returns `klippy PATH`. Needs the extra
        `passo[web]` and a card that is a folder; raises InputError if the socket cannot be made,
        and ImportError without the extra."""
        from passo.web.klippy.server import KlippySocket

        served = KlippySocket(self._bridge, path, log_file=log_file)
        self._web_thread.start(served.run(), endless=True)
        self._places.append(f"klippy {path}")
        return self._places[-1]

    async def serve(self) -> bool:
        """Serves the consoles until `end` is called; True if the printer must be opened again with
        its current machine file. If the printer ends with an error, raises that error."""
        assert self._serving is not None
        if (lock := self._opened.lock) is not None:
            lock.note(self._places)
        await asyncio.wait([self._serving])
        if not self._serving.cancelled():
            self._serving.result()
        return self._restart_wanted

    def end(self) -> None:
        """Ends `serve`."""
        assert self._serving is not None
        self._serving.cancel()

    def _restart(self) -> None:
        self._restart_wanted = True
        self.end()

    # -- within -----------------------------------------------------------------------------------

    @property
    def _opened(self) -> Assembly:
        if self._assembly is None:
            raise RuntimeError("the printer is not open: use `async with passo.Printer(…)`")
        return self._assembly

    @property
    def _printer(self) -> printers.Printer:
        return self._opened.printer

    @property
    def _observer(self) -> Observer:
        if self._observed is None:
            self._observed = Observer(self._opened.services)
        return self._observed

    @property
    def _bridge(self) -> LiveBridge:
        if self._bridged is None:
            from passo.library.bridge import LiveBridge

            opened = self._opened
            self._bridged = LiveBridge(
                *(opened.services, opened.settings, opened.restart, self._observer),
                *(self._source, self._places),
            )
        return self._bridged

    @property
    def _accounts(self) -> Accounts:
        if self._opened_accounts is None:
            from passo.web.accounts.accounts import Accounts
            from passo.web.accounts.store import Store

            store = Store(None if self._state is None else Path(self._state))
            self._opened_accounts = Accounts(store, wall_s=time.time, now_s=time.monotonic)
        return self._opened_accounts

    @property
    def _temperatures(self) -> TemperatureHistory:
        if self._kept_temperatures is None:
            from passo.web.temperature_history import TemperatureHistory

            self._kept_temperatures = TemperatureHistory()
        return self._kept_temperatures

    @property
    def _web_thread(self) -> WebThread:
        if self._web is None:
            from passo.web.server import WebThread

            self._web = WebThread()
            self._web.start(self._temperatures.record(self._bridge), endless=True)
        return self._web

    def _new_session(self, *, advanced_ok: bool) -> NewSession:
        def new_session(wire: Wire) -> Session:
            session = Session(self._printer.control, wire)
            session.advanced_ok = advanced_ok
            welcome(self.config.name, self._printer.state, session)
            return session

        return new_session

    async def _add(self, opening: Awaitable[Console]) -> str:
        console = await opening
        self._printer.lifetime.at_end(console.close)
        self._places.append(console.place)
        return console.place

    def _raise_if_ended(self) -> None:
        _ = self._opened
        if self._serving is not None and self._serving.done():
            raise MachineError.of("job.stopped", value="the printer has ended")

    def _ended(self, task: asyncio.Task[None]) -> None:
        """Called when the task of the printer has ended, normally or by a fault of the program."""
        error: BaseException = MachineError.of("job.stopped", value="the printer has ended")
        error = error if task.cancelled() else task.exception() or error
        if self._client is not None:
            self._client.fail_all(error)
        if self._bridged is not None:
            self._bridged.fail_all(error)
        for future in self._prints:
            if not future.done():
                future.set_exception(error)
        for queue in self._queues:
            queue.put_nowait(None)
