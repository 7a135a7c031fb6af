"""One printer: its board, its plan, its commands, and whose turn it is."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from passo import _core
from passo.board.ports import LinkLostError
from passo.config.drives import axis_order
from passo.errors import CommandError, MachineError
from passo.printer.commands import Commands
from passo.printer.drive import MOST_QUEUED, TICK_S, Drive
from passo.printer.driver_commands import DriverCommands
from passo.printer.drivers import DriverWatch
from passo.printer.endstop_watch import EndstopWatch
from passo.printer.faults import problem_of
from passo.printer.heat_commands import HeatCommands
from passo.printer.homing import Homer
from passo.printer.lateness import LatenessWatch
from passo.printer.motion_commands import MotionCommands
from passo.printer.motors import Motors
from passo.printer.person import PersonCommands
from passo.printer.positions import Positions
from passo.printer.reconnection import reconnect
from passo.printer.tune_commands import TuneCommands
from passo.printer.turn import Turn
from passo.printer.waits import (
    Handler,
    Homing,
    Person,
    Procedure,
    Reply,
    Silence,
    Still,
    Temperatures,
    Tuning,
    Wait,
)
from passo.printer.wiring import connect, reconnected
from passo.printer.words import Command

if TYPE_CHECKING:
    from passo.board.boards import Boards
    from passo.board.faults import HeaterFault
    from passo.config.machine import MachineConfig


_FIRST_REPORTS_S = 0.6  # all sensors have spoken by then


class Stopped(Exception):
    """What was waited for will not come: somebody has stopped or cancelled it."""


class Printer:
    """A machine that takes commands from several sources. To be used within one event loop.

    `immediate` are the commands that act at once, whoever moves the machine; `planned` take their
    place on the timeline or wait for the machine. Both may be added to before the first command.
    """

    def __init__(self, machine: MachineConfig, *, free: bool = False) -> None:
        self.machine = machine
        self.heaters = list(machine.heaters)
        self._free = free
        self.closers: list[Callable[[], None]] = []  # called when the printer ends
        self.watchers: list[Callable[[], None]] = [self._look_after_idleness]  # time has passed
        connection, self.board = connect(machine)
        self.motors = Motors(self)
        self.drivers = DriverWatch(self)
        self.lateness = LatenessWatch(self)
        self.driver_commands = DriverCommands(self)
        self._begin(connection)
        self.turn = Turn()
        self.busy: Callable[[], bool] = lambda: False  # a print is under way, or paused
        self.settings: Callable[[], Iterable[str]] = tuple  # commands that bring them back
        self.heat = HeatCommands(self)
        self.motion = MotionCommands(self)
        self.person = PersonCommands(self)
        self.tunes = TuneCommands(self)
        self.endstops = EndstopWatch(self)
        self.watchers.append(self.endstops.time_passed)
        self.watchers.append(self.drivers.time_passed)
        self.watchers.append(self.lateness.time_passed)
        self.store_settings: Callable[[], object] = lambda: None
        self.immediate: dict[str, Handler] = (
            self.heat.immediate
            | self.motion.immediate
            | self.person.immediate
            | self.tunes.immediate
            | self.endstops.immediate
        )
        self.planned: dict[str, Handler] = (
            self.heat.planned
            | self.motion.planned
            | self.motors.planned
            | self.person.planned
            | self.tunes.planned
            | self.driver_commands.planned
        )
        self.stop_listeners: list[Callable[[str], None]] = []
        self.fault_listeners: list[Callable[[HeaterFault], None]] = []
        self.greeting: Callable[[], str] = str  # what a console that opens should hear
        self.listeners: list[Callable[[str], None]] = []
        self.program: Reply | None = None  # whose moves were planned last
        self.halted = ""  # why nothing moves or heats any more; M999 clears it
        self.heating = False  # somebody waits for a temperature
        self._skip = asyncio.Event()
        self._impatient = False  # the wait that goes on shall not even wait for moves
        self._revived = asyncio.Event()

    def _begin(self, connection: Boards) -> None:
        """Starts from boards that have just been configured, with nothing planned."""
        machine = self.machine
        connection.run(connection.now + int(_FIRST_REPORTS_S * machine.board.clock_hz))
        self.connection = connection
        connection.set_on_fault(self._heater_failed)
        self.drivers.begin(connection)
        self.job = _core.Job(machine.core_spec(), True, False, False)
        full = [connection.full_scale(o.name) for o in connection.board.outputs]
        self.commands = Commands(machine, self.job, self, full)
        self.drive = Drive(connection, self.job, free=self._free, set_target=self._apply_target)
        self.commands.record_at_once = self.drive.record_at_once
        self.drive.on_motion = self._before_motion
        self.drive.on_pass = self._time_passed
        self.homer = Homer(self)
        self.positions = Positions(self)
        if connection.adopted:
            self.motors.all_on()  # as the host before has left them
            self.positions.settle()
        if machine.unhomed_moves == "refuse":
            self.lock(self.homer.axes)

    def _before_motion(self) -> None:
        self.drivers.before_motion()
        if not self.halted:
            self.motors.all_on()

    def _time_passed(self) -> None:
        for watcher in self.watchers:
            watcher()

    def _look_after_idleness(self) -> None:
        idle_s, config = self.drive.idle_s, self.machine.idle
        if self.busy() or self.turn.taken:
            return
        if 0 < self.motors.idle_s < idle_s and self.motors.on:
            self.motors.all_off()
            self.tell("echo:Motors off after standing idle; home before the next move")
        if 0 < self.person.kill_s < idle_s:
            self.halt(f"idle for {self.person.kill_s:g} s (M85)")
        if 0 < config.heaters_off_s < idle_s:
            for name in self.heaters:
                if self.connection.heaters[name].target > 0:
                    self.set_target(name, 0.0, at_once=True)
                    self.tell(f"echo:Heater {name} off after standing idle")

    def lock(self, axes: Iterable[str]) -> None:
        """These axes no longer know where they are."""
        if self.machine.unhomed_moves == "refuse":
            order = axis_order(self.machine.axes)
            for name in axes:
                self.job.lock_axis(order.index(name), True)

    def close(self) -> None:
        """Lets go of files and of the board, heaters off; nothing may be asked of the printer after
        that."""
        for closer in self.closers:
            closer()
        self.connection.close()

    # -- what others may ask ----------------------------------------------------------------------

    def tell(self, text: str) -> None:
        """A line to all who listen."""
        for listener in list(self.listeners):
            listener(text)

    def set_target(self, heater: str, celsius: float, *, at_once: bool = False) -> None:
        """Sets a heater's target when the moves so far are done, or at once."""
        if at_once:
            self.connection.set_target(heater, celsius)
            return
        self.drive.before_moves()
        self.job.mark(self.heaters.index(heater), round(celsius * 100))
        self.drive.after_moves()

    def set_fan(self, fan: str, share: float) -> None:
        """Sets a fan's speed, 0 to 1, when the moves so far are done."""
        self.drive.before_moves()
        self.commands.set_output(fan, share)
        self.drive.after_moves()

    def go_on(self) -> None:
        """M108: ends the wait that goes on, for moves, time, temperatures or a person. Moves go
        on."""
        self.drive.skip_dwell()
        self.end_wait()

    def end_wait(self) -> None:
        """Whoever waits waits no more. What moves goes on, dwells too."""
        self._impatient = True
        self._skip.set()

    def halt(self, reason: str) -> None:
        """M112: heaters, motors and everything else off at once, until M999."""
        if self.halted:
            return
        self.halted = reason.rstrip(".")
        for name in self.heaters:
            self.connection.set_target(name, 0.0)
        self.connection.emergency_stop()
        self._skip.set()

    def revive(self) -> None:
        """M999: a halted printer begins anew, cold, and without knowing where it is."""
        if self.halted:
            self._revived.set()

    def can_extrude(self) -> bool:
        """The machine has filament, and the active tool's hotend is warm enough to move it."""
        return bool(self.machine.extruders) and self.heat.warm()

    def filament_mm(self) -> float:
        """Filament that all extruders together were to push so far, mm."""
        return sum(self.job.statistics()["filament_mm"])

    def planned_s(self) -> float:
        """Print time of all motion and dwell that was planned so far, seconds."""
        plan = self.job.statistics()
        return plan["move_s"] + plan["dwell_s"]

    def stop_by_endstop(self, names: Sequence[str]) -> None:
        """A switch was hit in mid-move: brakes, and ends the print if one is under way."""
        self.stop_all(f"endstop {', '.join(names)} was hit")

    def stop_all(self, reason: str) -> None:
        """M410: brakes to a stop on the path and forgets all moves that were planned. A print that
        moves the machine ends: what is left of it would not follow on."""
        self.stop()
        for listener in self.stop_listeners:
            listener(reason)

    def stop(self) -> None:
        """Brakes to a stop on the path and forgets all moves that were planned."""
        self.drive.stop()
        self.commands.laser_off()
        self._skip.set()

    # -- commands ---------------------------------------------------------------------------------

    def act(self, command: Command, reply: Reply) -> bool:
        """Carries out a command that acts at once when it comes from there; else False."""
        handler = self.immediate.get(command.code)
        in_order = command.code in self.motion.beside_only and not self.beside(reply)
        if handler is None or in_order:
            return False
        self._carried_out(handler, command, reply)
        return True

    def has_room(self) -> bool:
        """A planned line can be taken in without a wait, by whoever has the turn."""
        if not self.job.at_boundary:
            return False
        # Beside a print the plan is always full: a line comes behind what is planned.
        return self.job.queued <= MOST_QUEUED if self.busy() else not self.drive.full

    def beside(self, reply: Reply) -> bool:
        """Who asks is not the one whose moves are planned: a console beside a print from the card,
        or beside another console."""
        return reply is not self.program

    def select(self, *, console: bool) -> None:
        """What is read next comes from a console, or else from the file."""
        self.job.select(console)
        self.heat.guard_extrusion()

    def take_line(self, text: str, reply: Reply) -> Wait | None:
        """Takes in one line of a console: all of it, or up to a command that waits; then `finish`
        goes on. Only with the turn and with room."""
        self.select(console=True)
        job = self.job
        job.feed(text.encode("ascii", "replace") + b"\n")
        before = job.queued, job.clock
        wait = self._go_on(reply)
        if not self.busy() and (job.queued, job.clock) != before:
            self.program = reply
        return wait

    def take_setting(self, text: str, reply: Reply) -> None:
        """Carries out one line of stored settings, the machine standing, by who has the turn."""
        self.select(console=True)
        self.job.feed(text.encode("ascii", "replace") + b"\n")
        wait = self._go_on(reply)
        while wait is not None:
            if isinstance(wait, Still) and wait.then is not None:
                self.drive.flush()
                wait.then()
            wait = self._go_on(reply)

    async def finish(self, wait: Wait | None, reply: Reply) -> None:
        """The rest of a line whose command waits. Raises Stopped or MachineError."""
        while wait is not None:
            await self.wait(wait, reply)
            self.select(console=True)
            wait = self._go_on(reply)

    def _carried_out(self, handler: Handler | None, command: Command, reply: Reply) -> Wait | None:
        """By a handler of a living printer, or as in a print without consoles."""
        try:
            return handler(command, reply) if handler else self.commands.run(command)
        except (CommandError, LinkLostError) as error:
            reply.fail(str(error))
            return None

    def run_command(self, command: Command, reply: Reply) -> Wait | None:
        """Carries out a command that the interpreter handed out."""
        self.drive.before_moves()
        handler = self.planned.get(command.code) or self.immediate.get(command.code)
        before = self.commands.unknown.get(command.code)
        wait = self._carried_out(handler, command, reply)
        if self.commands.unknown.get(command.code) != before:
            reply.say(f'echo:Unknown command: "{command.code}"')
        return wait

    async def wait(self, wait: Wait, reply: Reply) -> None:
        """Waits with the machine at rest. Raises Stopped when it was halted meanwhile."""
        self._skip.clear()
        self._impatient = False
        self.drive.flush()
        await self.drive.until(lambda: self.drive.standing or self._impatient or bool(self.halted))
        self.raise_if_halted()
        if isinstance(wait, Homing) or (isinstance(wait, Still) and wait.then is not None):
            self._raise_if_skipped()
        if isinstance(wait, Still) and wait.then is not None:
            wait.then()
        elif isinstance(wait, Temperatures):
            await self._reach(wait, reply)
        elif isinstance(wait, Procedure):
            await wait.run()
        elif isinstance(wait, Tuning):
            await self._tune(wait)
        elif isinstance(wait, Person):
            await self._person(wait, reply)
        elif isinstance(wait, Homing):
            self.job.abandon()
            await self.homer.home(wait.letters)
        self.raise_if_halted()

    def _raise_if_skipped(self) -> None:
        if self._skip.is_set():
            self.job.abandon()
            raise Stopped("it was stopped")

    @property
    def interrupted(self) -> bool:
        """Somebody wants the wait that goes on to end: M108, M410 or a halt."""
        return self._skip.is_set() or bool(self.halted)

    def raise_if_interrupted(self) -> None:
        """Raises Stopped after M108, M410 or a halt."""
        self.raise_if_halted()
        if self._skip.is_set():
            raise Stopped("it was stopped")

    def raise_if_halted(self) -> None:
        """Raises Stopped while the machine is halted."""
        if self.halted:
            raise Stopped(self.halted)

    async def run(self) -> None:
        """Keeps the printer alive until cancelled. A failed board halts it, until it is revived."""
        while True:
            try:
                await self.drive.run()
            except MachineError as error:
                self.lateness.board_failed()
                failure = await self._reconnect(error)
                if failure is None:
                    continue
                self.halted = self.halted or str(failure).rstrip(".")
                self._make_safe()
                self.tell(f"Error:Printer halted: {self.halted}. Make it safe, then send M999")
                self.drive.end_waits()
                await self._revived.wait()
                self._revived.clear()
                await self._all_have_stopped()
                try:
                    await self._revive()
                finally:
                    self.turn.give()

    async def _reconnect(self, error: MachineError) -> MachineError | None:
        """After a lost link goes on where the board has stopped by itself; else what halts it."""
        if self.halted or not isinstance(error, LinkLostError) or not self.connection.survives:
            return error
        try:
            await reconnect(self, error)
        except MachineError as failure:
            return failure
        return None

    async def _all_have_stopped(self) -> None:
        """Takes the turn: who had it has heard of the halt by then, and waits for nothing of the
        old plan any more."""
        while not self.turn.take():
            self.drive.end_waits()
            await asyncio.sleep(TICK_S)

    def _make_safe(self) -> None:
        """The board may only have been silent for a moment: it must not go on when it is back."""
        for name in self.heaters:
            self.connection.set_target(name, 0.0)
        self.connection.stop_job()
        self.connection.emergency_stop()

    async def _revive(self) -> None:
        """Begins anew; as often as somebody asks, until the board can be reached."""
        while True:
            try:
                return self._begin_anew()
            except MachineError as error:
                self.tell(f"Error:{error} Then send M999 again")
                await self._revived.wait()
                self._revived.clear()

    def _begin_anew(self) -> None:
        for listener in self.stop_listeners:
            listener(self.halted)
        self.motors.forget()
        self.motion.homed("xyz")
        lines = list(self.settings())
        self._begin(reconnected(self.connection))
        self.endstops.begin()
        self.halted = ""
        for line in lines:
            self.take_setting(line, Silence())
        self.tell("echo:The printer is ready again. Home it before you move it")

    def _heater_failed(self, _: str, fault: HeaterFault) -> None:
        """A protection has switched a heater off; how much more stops is the heater's policy."""
        policy = self.machine.heaters[fault.heater].on_fault
        if policy == "machine":
            self.halt(str(fault))
            return
        self.tell(f"echo:{fault}")
        if policy == "job":
            for listener in self.fault_listeners:
                listener(fault)

    # -- within -----------------------------------------------------------------------------------

    def _apply_target(self, heater: int, celsius: float) -> None:
        self.connection.set_target(self.heaters[heater], celsius)

    def _go_on(self, reply: Reply) -> Wait | None:
        status = _core.JobStatus
        self.drive.before_moves()
        try:
            while True:
                found = self.job.advance()
                if found == status.EVENT:
                    wait = self.run_command(Command(*self.job.event), reply)
                    self.commands.ended = False  # a console has no program to end
                    if wait is not None:
                        return wait
                elif found == status.ERROR:
                    reply.fail(str(problem_of(self.job, "")))
                    self.job.abandon()
                    return None
                else:
                    return None
        finally:
            self.drive.after_moves()

    async def _reach(self, wait: Temperatures, reply: Reply) -> None:
        self.heating = True
        heaters = [self.connection.heaters[name] for name in wait.heaters]

        def there() -> bool:
            return (
                self.interrupted
                or any(h.fault for h in heaters)
                or all(
                    h.target <= 0
                    or h.reached
                    or (h.target <= h.celsius <= h.limits.max_c and not wait.cooling)
                    for h in heaters
                )
            )

        try:
            await self.drive.until(there)
        finally:
            self.heating = False
        faults = [f for f in self.connection.faults if f.heater in wait.heaters]
        if any(h.fault for h in heaters) and not self.halted:
            raise CommandError([faults[-1].problem])

    async def _tune(self, wait: Tuning) -> None:
        self.heating = True
        try:
            await self.drive.until(lambda: wait.step() or self.interrupted)
        finally:
            self.heating = False
            if not self.halted:
                wait.finish()

    async def _person(self, wait: Person, reply: Reply) -> None:
        reply.say("echo:busy: paused for user")
        end = self.drive.now + wait.seconds * self.drive.hz
        await self.drive.until(
            lambda: self.interrupted or (wait.seconds > 0 and self.drive.now >= end)
        )
