"""The web's bridge to a live printer: calls cross to the printer's loop, snapshots come back."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Collection, Coroutine, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from io import BytesIO
from typing import TYPE_CHECKING, Any, TypeVar

from passo.board.fault_injection import NO_FAULT
from passo.card.unheld import Unheld
from passo.console.client import Client
from passo.console.session import command_of
from passo.errors import CommandError, ConfigError, PassoError
from passo.gcode.command import Command
from passo.gcode.line_protocol import uncommented
from passo.gcode.registry import table
from passo.library.planning import Planning
from passo.library.planning_work import find_explanation, find_fitting, find_verdict
from passo.web.bridge import BedState, PastPrint, SettingValue, SimulatedPart, Snapshot

if TYPE_CHECKING:
    from passo.card import Card, Writer
    from passo.config.machine import MachineConfig
    from passo.console.settings_commands import SettingsCommands
    from passo.events import Event
    from passo.gcode.registry import Declaration
    from passo.job.batch.verdict import Verdict
    from passo.job.live.runs import Run
    from passo.learn.explanation import Explanation
    from passo.library.planning import Work
    from passo.printer.console_lines import ConsoleLine
    from passo.printer.program_restart import ProgramRestart
    from passo.printer.status import PrinterState, Queue, QueuedPrint, Status
    from passo.printer.unfit_commands import Skips
    from passo.services.observer import Observer
    from passo.services.services import Services
    from passo.web.bridge import Listener, OnLine

_T = TypeVar("_T")
# Between two snapshots, of host time, or of print time if that is faster.
TICK_S = 0.25  # while a listener receives them
IDLE_TICK_S = 1.0  # else


class LiveBridge:
    """The bridge of one printer. Create and `close` it in the printer's loop; call `listen` and all
    methods after it in the web's loop. The latest snapshot includes each call that has returned."""

    def __init__(
        self,
        services: Services,
        settings: SettingsCommands,
        restart: ProgramRestart | None,
        observer: Observer,
        machine_source: str,
        places: Sequence[str] = (),
    ) -> None:
        """`restart` restarts the program; None if it cannot restart. `places` are the open
        addresses; the list may grow later."""
        self._control, self._parts = services.control, services.parts
        self._status, self._jobs = services.status, services.jobs
        self._settings, self._restart = settings, restart
        self._source, self._places = machine_source, places
        self._loop = asyncio.get_running_loop()
        self._scripts = Client(self._control)
        self._overtaking = Client(self._control)
        self._closed = False
        self._turn = asyncio.Lock()  # scripts run one after the other
        self._in_turn = 0  # scripts that run or wait for their turn
        self._listeners: dict[asyncio.AbstractEventLoop, list[Listener]] = {}
        self._planner = ThreadPoolExecutor(1, "plan")  # waits for the process that plans
        self._plannings: set[Planning[Any]] = set()
        self._line_listeners: list[
            tuple[asyncio.AbstractEventLoop, Callable[[ConsoleLine], None]]
        ] = []  # changed in the printer's loop
        self._latest = self._published = self._snapshot(0, self._status.read())
        self._observer = observer
        self._every_s: float = IDLE_TICK_S
        self._end_status = observer.on_status(self._tick, IDLE_TICK_S)
        self._end_events = observer.on_event(self._event, IDLE_TICK_S)

    def close(self) -> None:
        """Ends all calls."""
        self._closed = True
        self._end_status()
        self._end_events()
        self._listeners.clear()
        self._line_listeners.clear()
        for client in (self._scripts, self._overtaking):
            client.close()
        self._planner.shutdown(wait=False, cancel_futures=True)
        for planning in list(self._plannings):
            planning.end()

    def fail_all(self, error: BaseException) -> None:
        """Ends all open calls: the printer has ended, and no command is answered any more."""
        for client in (self._scripts, self._overtaking):
            client.fail_all(error)

    # -- the printer's loop -----------------------------------------------------------------------

    def _snapshot(self, version: int, status: Status) -> Snapshot:
        return Snapshot(version, time.monotonic(), status)

    def _refresh(self, status: Status) -> None:
        if status != self._latest.status:
            self._latest = self._snapshot(self._latest.version + 1, status)

    def _tick(self, status: Status) -> None:
        self._refresh(status)
        if (snapshot := self._latest) is not self._published:
            self._published = snapshot
            self._tell(lambda listener: listener.on_snapshot(snapshot))

    def _called(self) -> None:
        """Updates `latest` after a call. Listeners receive the snapshot with the next tick, so that
        many calls do not cause many messages, or at once if the state of the printer or of the
        print has changed."""
        status = self._status.read()
        self._refresh(status)
        if _does(self._latest) != _does(self._published):
            self._tick(status)

    def _set_pace(self) -> None:
        """Sets how often snapshots are taken."""
        every_s = TICK_S if any(list(self._listeners.values())) else IDLE_TICK_S
        if every_s != self._every_s and not self._closed:
            self._every_s = every_s
            self._end_status()
            self._end_status = self._observer.on_status(self._tick, every_s)

    def _tell(self, tell: Callable[[Listener], None]) -> None:
        """Calls `tell` in each loop once, for any number of listeners."""
        for loop, listeners in list(self._listeners.items()):
            _call(loop, partial(_tell_each, listeners, tell))

    async def _run(
        self, script: Sequence[str | Command], on_line: OnLine | None, sender: str
    ) -> tuple[str, ...]:
        try:
            return await self._carry_out(script, on_line, sender)
        finally:
            self._called()

    async def _carry_out(
        self, script: Sequence[str | Command], on_line: OnLine | None, sender: str
    ) -> tuple[str, ...]:
        if self._overtakes(script):
            return await self._send(self._overtaking, script, on_line, sender)
        self._in_turn += 1
        try:
            async with self._turn:
                return await self._send(self._scripts, script, on_line, sender)
        finally:
            self._in_turn -= 1

    async def _send(
        self, client: Client, script: Sequence[str | Command], on_line: OnLine | None, sender: str
    ) -> tuple[str, ...]:
        client.sender = sender
        self._control.rig.commands.klipper.unrestored.clear()
        answers: list[str] = []
        try:
            for one in script:
                line = isinstance(one, str)
                reply = await (client.send(one, on_line) if line else client.execute(one, on_line))
                answers += reply.lines
        except PassoError:
            await self._restore_states(client)
            raise
        return tuple(answers)

    def _overtakes(self, script: Sequence[str | Command]) -> bool:
        """Whether each line of a script acts at once, so that the script need not wait for the one
        before. Heaters and fans that are set while a command moves the machine by itself do not
        overtake scripts that wait for its end."""
        dispatch = self._control.dispatch
        commands = [
            command_of(text) if isinstance(one, str) else one
            for one in script
            if (text := uncommented(one) if isinstance(one, str) else one.code)
        ]
        waits = self._in_turn > 1 and any(map(dispatch.sets_meanwhile, commands))
        return bool(commands) and not waits and all(map(dispatch.overtakes, commands))

    async def _restore_states(self, client: Client) -> None:
        """After a failure, restores the states that the script has saved, so that lines are read as
        before it."""
        for name in reversed(list(self._control.rig.commands.klipper.unrestored)):
            with suppress(PassoError):  # the printer has halted
                await client.execute(Command.call("RESTORE_GCODE_STATE", NAME=name))

    def _line(self, line: ConsoleLine) -> None:
        for loop, call in list(self._line_listeners):
            _call(loop, partial(call, line))

    def _event(self, event: Event) -> None:
        self._tick(self._status.read())  # the snapshot must include what the event reports
        self._tell(lambda listener: listener.on_event(event))

    # -- the web's loop ---------------------------------------------------------------------------

    async def _cross(self, coroutine: Coroutine[Any, Any, _T]) -> _T:
        """Runs a coroutine in the printer's loop, and cancels it when the caller is cancelled."""
        return await asyncio.wrap_future(asyncio.run_coroutine_threadsafe(coroutine, self._loop))

    async def _call(self, action: Callable[[], _T]) -> _T:
        async def run() -> _T:
            try:
                return action()
            finally:
                self._called()

        return await self._cross(run())

    @property
    def machine(self) -> MachineConfig:
        """Like `Bridge.machine`."""
        return self._control.machine

    @property
    def machine_source(self) -> str:
        """Like `Bridge.machine_source`."""
        return self._source

    @property
    def skips(self) -> Skips:
        """Like `Bridge.skips`."""
        return self._control.skips

    @property
    def places(self) -> Sequence[str]:
        """Like `Bridge.places`."""
        return tuple(self._places)

    @property
    def commands(self) -> Sequence[Declaration]:
        """Like `Bridge.commands`."""
        has = self._control.dispatch.has
        return tuple(row for row in table().values() if has(row))

    def latest(self) -> Snapshot:
        """Like `Bridge.latest`."""
        return self._latest

    def listen(self, listener: Listener) -> Callable[[], None]:
        """Like `Bridge.listen`."""
        listeners = self._listeners.setdefault(asyncio.get_running_loop(), [])
        listeners.append(listener)
        _call(self._loop, self._set_pace)

        def end() -> None:
            if listener in listeners:
                listeners.remove(listener)
                _call(self._loop, self._set_pace)

        return end

    def console_history(self) -> list[ConsoleLine]:
        """Like `Bridge.console_history`."""
        return self._control.state.console_lines.last()

    def on_console_line(self, call: Callable[[ConsoleLine], None]) -> Callable[[], None]:
        """Like `Bridge.on_console_line`."""
        entry = (asyncio.get_running_loop(), call)
        lines = self._control.state.console_lines

        def begin() -> None:
            self._line_listeners.append(entry)
            if self._line not in lines.listeners:
                lines.listeners.append(self._line)

        def end() -> None:
            if entry in self._line_listeners:
                self._line_listeners.remove(entry)
            if not self._line_listeners and self._line in lines.listeners:
                lines.listeners.remove(self._line)

        _call(self._loop, begin)
        return lambda: _call(self._loop, end)

    async def run(
        self, script: str, on_line: OnLine | None = None, *, sender: str = ""
    ) -> tuple[str, ...]:
        """Like `Bridge.run`."""
        loop = asyncio.get_running_loop()

        def cross_back(line: str) -> None:
            if on_line is not None:
                _call(loop, partial(on_line, line))

        lines = script.splitlines()
        return await self._cross(self._run(lines, None if on_line is None else cross_back, sender))

    async def call(self, *commands: Command, sender: str = "") -> tuple[str, ...]:
        """Like `Bridge.call`."""
        return await self._cross(self._run(commands, None, sender))

    async def endstops(self) -> dict[str, bool]:
        """Like `Bridge.endstops`."""

        def states() -> dict[str, bool]:
            if self._control.state.halted:
                raise CommandError.of("command.halted", value=self._control.state.halted)
            return self._parts.motion.homer.states()

        return await self._call(states)

    def emergency_stop(self) -> None:
        """Like `Bridge.emergency_stop`."""
        self._loop.call_soon_threadsafe(self._control.stops.emergency_stop)

    async def restart(self) -> None:
        """Like `Bridge.restart`."""
        await self.call(Command.call("M999"))

    async def restart_program(self) -> None:
        """Like `Bridge.restart_program`."""
        restart = self._restart
        if restart is None:
            raise ConfigError.of("machine.no-restart")
        await asyncio.to_thread(restart.check)
        await self._call(restart.begin)

    async def select_file(self, path: str) -> None:
        """Like `Bridge.select_file`."""
        await self._call(lambda: self._jobs.files.open(path))

    async def start_print(self, path: str, allow: Collection[str] = (), run: str = "") -> bool:
        """Like `Bridge.start_print`."""
        return await self._call(lambda: self._jobs.start(path, allow, run))

    async def run_of(self, run: str) -> Run:
        """Like `Bridge.run_of`."""
        return await self._call(lambda: self._jobs.runs.find(run))

    async def pause_print(self) -> None:
        """Like `Bridge.pause_print`."""
        await self._call(self._jobs.runner.pause)

    async def resume_print(self) -> None:
        """Like `Bridge.resume_print`."""
        await self._call(self._jobs.runner.start)

    async def cancel_print(self) -> None:
        """Like `Bridge.cancel_print`."""
        await self._call(self._jobs.runner.cancel)

    async def cancel_object(self, number: int, *, cancelled: bool) -> None:
        """Like `Bridge.cancel_object`."""
        await self._call(lambda: self._jobs.objects.cancel(number, cancelled=cancelled))

    async def past_prints(self, most: int) -> list[PastPrint]:
        """Like `Bridge.past_prints`."""
        rows = await self._call(lambda: self._jobs.statistics.last(most))
        return [PastPrint(*row) for row in rows]

    async def queue(self) -> Queue:
        """Like `Bridge.queue`."""
        return await self._call(self._jobs.queue.status)

    async def queue_print(self, path: str) -> QueuedPrint:
        """Like `Bridge.queue_print`."""
        return await self._call(lambda: self._jobs.queue.add(path))

    async def unqueue_print(self, number: int) -> None:
        """Like `Bridge.unqueue_print`."""
        await self._call(lambda: self._jobs.queue.remove(number))

    async def move_queued_print(self, number: int, place: int) -> None:
        """Like `Bridge.move_queued_print`."""
        await self._call(lambda: self._jobs.queue.move(number, place))

    async def set_queue_mode(self, *, automatic: bool) -> None:
        """Like `Bridge.set_queue_mode`."""
        await self._call(lambda: self._jobs.queue.set_automatic(automatic))

    async def start_queued_print(self) -> None:
        """Like `Bridge.start_queued_print`."""
        await self._call(self._jobs.queue.start_next)

    async def settings(self) -> list[SettingValue]:
        """Like `Bridge.settings`."""
        rows = await self._call(lambda: list(self._settings.provenance()))
        return [
            SettingValue(group.heading, one.head, one.word, one.value, file, stored, source)
            for group, one, file, stored, source in rows
        ]

    async def bed(self) -> BedState:
        """Like `Bridge.bed`."""
        bed = self._parts.motion.correction
        return await self._call(lambda: BedState(bed.correction, bed.on))

    async def simulated_parts(self) -> list[SimulatedPart]:
        """Like `Bridge.simulated_parts`."""

        def parts() -> list[SimulatedPart]:
            injector = self._control.rig.connection.injector
            if injector is None:
                return []
            active = injector.active
            return [
                SimulatedPart(part, faults, active.get(part, NO_FAULT))
                for part, faults in injector.values.items()
            ]

        return await self._call(parts)

    async def card(self) -> Card:
        """Like `Bridge.card`."""
        return await self._call(lambda: self._jobs.files.card)

    async def create_file(self, path: str) -> Writer:
        """Like `Bridge.create_file`."""
        return await self._call(lambda: self._jobs.files.create(path))

    async def remove_file(self, path: str) -> None:
        """Like `Bridge.remove_file`."""
        await self._call(lambda: self._jobs.files.remove(path))

    async def rename(self, path: str, to: str) -> None:
        """Like `Bridge.rename`."""
        await self._call(lambda: self._jobs.files.let_go(path))
        card = await self.card()
        await asyncio.to_thread(card.rename, path, to)  # which may copy a file

    async def verdict(self, path: str, take_path: Callable[[bytes], None] | None = None) -> Verdict:
        """Like `Bridge.verdict`."""
        saved = self._latest.status.saved_variables
        work = partial(find_verdict, self.machine, self.skips, saved, _name(path))
        return await self._planned(work, path, take_path)

    async def fitting_machines(self, path: str, most: int) -> list[str]:
        """Like `Bridge.fitting_machines`."""
        return await self._planned(
            partial(find_fitting, self.machine.name, most, _name(path)), path
        )

    async def explain(self, path: str, line: int) -> Explanation:
        """Like `Bridge.explain`."""
        return await self._planned(partial(find_explanation, self.machine, _name(path), line), path)

    async def explain_line(self, line: str, *, before: str = "", after: str = "") -> Explanation:
        """Like `Bridge.explain_line`."""
        lines = [*before.splitlines(), line, *after.splitlines()]
        text = "\n".join(lines).encode()
        number = len(before.splitlines()) + 1
        work = partial(find_explanation, self.machine, "line.gcode", number)
        return await self._plan(Planning(work, BytesIO(text), len(text)))

    async def _planned(
        self, work: Work[_T], path: str, take_path: Callable[[bytes], None] | None = None
    ) -> _T:
        source = await asyncio.to_thread(Unheld, await self.card(), path)
        return await self._plan(Planning(work, source, source.size, take_path))

    async def _plan(self, planning: Planning[_T]) -> _T:
        self._plannings.add(planning)
        begun = self._planner.submit(planning.run)
        try:
            return await asyncio.wrap_future(begun)
        finally:
            self._plannings.discard(planning)
            planning.end()


def _does(snapshot: Snapshot) -> tuple[PrinterState, bool]:
    return snapshot.status.state, snapshot.status.job is None


def _name(path: str) -> str:
    return path.rpartition("/")[2]


def _tell_each(listeners: list[Listener], tell: Callable[[Listener], None]) -> None:
    for listener in list(listeners):
        tell(listener)


def _call(loop: asyncio.AbstractEventLoop, action: Callable[[], None]) -> None:
    with suppress(RuntimeError):  # the web has ended
        loop.call_soon_threadsafe(action)
