"""One printer: its board, its plan, its commands, and whose turn it is."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from typing import TYPE_CHECKING

from passo import _core
from passo.board.ports import LinkLostError
from passo.config.motor_roles import axis_order
from passo.errors import CommandError, MachineError
from passo.gcode.command import Command, alone
from passo.gcode.dialect import Kind, row_of
from passo.motion.homing import Homer
from passo.motion.motion_queue import MOST_QUEUED, Drive
from passo.motion.positions import Positions
from passo.printer.commands.beeper import Beeper
from passo.printer.commands.drivers import DriverCommands
from passo.printer.commands.heater_control import ControlCommands
from passo.printer.commands.heater_tuning import TuneCommands
from passo.printer.commands.motors import Motors
from passo.printer.commands.power_supply import Mains
from passo.printer.commands.program import Commands, forced
from passo.printer.commands.simulated_faults import SimulatedFaultCommands
from passo.printer.commands.steps_and_offsets import MotionCommands
from passo.printer.commands.temperature import HeatCommands
from passo.printer.commands.user_prompts import PersonCommands
from passo.printer.motion_lock import Turn
from passo.printer.recovery.supervisor import Life
from passo.printer.setup.boards import connect
from passo.printer.unfit_commands import NOTHING, Skips, unfit
from passo.printer.wait_requests import (
    Handler,
    Person,
    Reply,
    Room,
    Silence,
    Still,
    Stopped,
    Temperatures,
    Wait,
)
from passo.printer.wait_runner import Waiting
from passo.printer.watch.automatic_fans import FollowingFans
from passo.printer.watch.driver_status import DriverWatch
from passo.printer.watch.endstops import EndstopWatch
from passo.printer.watch.idle_timeout import look_after_idleness
from passo.printer.watch.late_commands import LatenessWatch

if TYPE_CHECKING:
    from passo.board.boards import Boards
    from passo.board.faults import HeaterFault
    from passo.config.machine import MachineConfig


# A sensor that is broken is known by two reports, 0.3 s apart; sensors report one after the other.
_FIRST_REPORTS_S, _NEXT_SENSOR_S = 0.6, 0.1
# What stops a machine at once waits in a file, which is read ahead, for the moves before it.
_IN_THEIR_TURN = ("M25", "M112", "M410", "M524")


class Printer:
    """A machine that takes commands from several sources. To be used within one event loop.

    `immediate` are the commands that act at once, whoever moves the machine; `planned` take their
    place on the timeline or wait for the machine. Both may be added to before the first command.
    """

    def __init__(
        self, machine: MachineConfig, *, free: bool = False, skips: Skips = NOTHING
    ) -> None:
        self.machine = machine
        self.skips = skips  # commands that prints may leave out
        self.heaters = list(machine.heaters)
        self._free = free
        self.closers: list[Callable[[], None]] = []  # called when the printer ends, the last first
        self.watchers: list[Callable[[], None]] = [
            partial(look_after_idleness, self)
        ]  # time has passed
        connection, self.board = connect(machine)
        self.mains = Mains(self)
        self.beeper = Beeper(self)
        self.watchers.append(self.beeper.time_passed)
        self.motors = Motors(self)
        self.drivers = DriverWatch(self)
        self.lateness = LatenessWatch(self)
        self.driver_commands = DriverCommands(self)
        self.begin(connection, first=True)
        self.turn = Turn()
        self.busy: Callable[[], bool] = lambda: False  # a print is under way, or paused
        self.end_asking: Callable[[], None] = lambda: None  # a paused file goes on, if it asks
        self.settings: Callable[[], Iterable[str]] = tuple  # commands that bring them back
        self.heat = HeatCommands(self)
        self.motion = MotionCommands(self)
        self.person = PersonCommands(self)
        self.controls = ControlCommands(self)
        self.tunes = TuneCommands(self, self.controls)
        self.endstops = EndstopWatch(self)
        self.faults = SimulatedFaultCommands(self, free=free)
        self.watchers.append(self.endstops.time_passed)
        self.watchers.append(FollowingFans(self).time_passed)
        self.watchers.append(self.drivers.time_passed)
        self.watchers.append(self.lateness.time_passed)
        self.store_settings: Callable[[], object] | None = None  # durably; None: nowhere
        self.immediate: dict[str, Handler] = (
            self.heat.immediate
            | self.motion.immediate
            | self.person.immediate
            | self.controls.immediate
            | self.endstops.immediate
            | self.faults.immediate
        )
        self.planned: dict[str, Handler] = (
            {"M112": self._halt_by_line, "M410": self._stop_by_line}
            | self.heat.planned
            | self.motion.planned
            | self.mains.planned
            | self.beeper.planned
            | self.motors.planned
            | self.person.planned
            | self.tunes.planned
            | self.driver_commands.planned
        )
        self.command_listeners: list[Callable[[Command, Reply], None]] = []  # of what was done
        self.line_listeners: list[Callable[[bool], None]] = []  # a console's begins, or was `done`
        self.stop_listeners: list[Callable[[str], None]] = []
        self.fault_listeners: list[Callable[[HeaterFault], None]] = []
        self.greeting: Callable[[], str] = str  # what a console that opens should hear
        self.listeners: list[Callable[[str], None]] = []
        self.unheard: list[str] = []  # told before anybody listened, for the console that opens
        self.program: Reply | None = None  # whose moves were planned last
        self.aside = False  # what a host prints stands aside: no more of its lines now
        self.halted = ""  # why nothing moves or heats any more; M999 clears it
        self.failures = 0  # halts and failed heaters so far: what lifts one comes after it
        self.cooled_c: dict[str, float] = {}  # heaters that are off for as long as a pause lasts
        self.waits = Waiting(self)
        self.life = Life(self)

    def begin(self, connection: Boards, *, first: bool = False) -> None:
        """Starts from boards that have just been configured, with nothing planned. Raises
        MachineError, and lets go of them then; a machine that fails at the `first` start is a
        printer all the same, for `report_start` to halt."""
        try:
            self._begin(connection, first=first)
            if not first:
                self._report_faults()
        except BaseException:
            connection.close()
            raise

    def _first_reports(self, connection: Boards) -> MachineError | None:
        """Lets all sensors report; what has failed by then and stops the machine."""
        found: list[HeaterFault] = []
        connection.set_on_fault(lambda _, fault: found.append(fault))
        try:
            seconds = _FIRST_REPORTS_S + _NEXT_SENSOR_S * len(self.heaters)
            connection.run(connection.now + int(seconds * self.machine.board.clock_hz))
        except MachineError as error:
            return error
        halting = [f for f in found if self.machine.heaters[f.heater].on_fault == "machine"]
        self._first_faults = [fault for fault in found if fault not in halting]
        return MachineError([fault.problem for fault in halting]) if halting else None

    def _report_faults(self) -> None:
        faults, self._first_faults = self._first_faults, []
        for fault in faults:
            self._heater_failed(fault.heater, fault)

    def report_start(self) -> None:
        """Reports what failed at the first start, and halts the printer if it must not run."""
        self._report_faults()
        if self.start_failure is not None:
            self.halt(str(self.start_failure))

    def _begin(self, connection: Boards, *, first: bool) -> None:
        self._first_faults: list[HeaterFault] = []
        self.start_failure: MachineError | None = None  # of the first start, until M999 ends it
        self._shaded = False  # the laser is dark for now, and will be lit again
        machine = self.machine
        if connection.survives:
            connection.arm(True)  # from here on no word that comes late shuts a board down
        self.mains.begin(connection)
        self.beeper.begin(connection)
        failure = self._first_reports(connection)
        if failure is not None and not first:
            raise failure
        self.connection = connection
        connection.set_on_fault(self._heater_failed)
        try:
            self.drivers.begin(connection)
        except MachineError as error:
            if not first:
                raise
            failure = failure or error
        self.start_failure = failure
        self.job = _core.Job(machine.core_spec(), True, False, False)
        self._from_console = False  # what is read is a console's line
        full = [connection.full_scale(o.name) for o in connection.board.outputs]
        self.commands = Commands(machine, self.job, self, full)
        self.drive = Drive(connection, self.job, free=self._free, on_mark=self._mark_reached)
        self.commands.record_at_once = self.drive.record_at_once
        self._stopped_tool = 0
        self.drive.on_motion = self._before_motion
        self.drive.on_pass = self._time_passed
        self.homer = Homer(self)
        self.positions = Positions(self)
        if connection.adopted:
            # No board tells whether the host before has left them on. So they go off when the
            # machine stands idle, and what the journal says decides where it stands.
            self.motors.all_on()
            self.positions.settle()
        if machine.unhomed_moves == "refuse":
            self.lock(self.homer.axes)

    def _before_motion(self) -> None:
        if not self.mains.on:
            self.halt("the power supply is off, and a motor was to move")
        self.drivers.before_motion()
        if not self.halted:
            self.motors.all_on()

    def _time_passed(self) -> None:
        for watcher in self.watchers:
            watcher()

    async def warm_again(self) -> None:
        """What a long pause or a fault has switched off warms up, unless somebody has set it
        meanwhile; a bed or chamber that fails is done without. With the turn. Raises Stopped, and
        CommandError where a hotend fails."""
        cooled, self.cooled_c = self.cooled_c, {}
        for name, celsius in cooled.items():
            self.connection.set_target(name, celsius)
        if cooled:
            self.drive.before_moves()  # it stands idle no longer
        waited: list[str] = list(cooled)
        while waited:
            try:
                await self.waits.wait(Temperatures(tuple(waited)), Silence())
                return
            except CommandError:
                failed = {n for n in waited if self.connection.heaters[n].fault is not None}
                if not failed or any(self.machine.heaters[n].kind == "hotend" for n in failed):
                    self.cooled_c = cooled | self.cooled_c  # who tries again waits again
                    raise
                waited = [n for n in waited if n not in failed]

    def rearm_failed(self) -> None:
        """Somebody was told of the heaters for which a print pauses, and wants it to go on."""
        for name in self.cooled_c:
            if self.connection.heaters[name].fault is not None:
                self.connection.heaters[name].rearm()

    def lock(self, axes: Iterable[str]) -> None:
        """These axes no longer know where they are."""
        axes = list(axes)
        self.positions.known.difference_update(axes)
        if self.machine.unhomed_moves == "refuse":
            order = axis_order(self.machine.axes)
            for name in axes:
                self.job.lock_axis(order.index(name), True)

    def close(self) -> None:
        """Lets go of the board, heaters and laser off, then of all else,
        whatever fails. Nothing may be asked of the printer after that."""
        self.drive.close()
        with ExitStack() as last_comes_first:
            for closer in self.closers:
                last_comes_first.callback(closer)
            last_comes_first.callback(self.connection.close)

    # -- what others may ask ----------------------------------------------------------------------

    def tell(self, text: str) -> None:
        """A line to all who listen."""
        for listener in list(self.listeners):
            listener(text)

    def set_target(self, heater: str, celsius: float, *, at_once: bool = False) -> None:
        """Sets a heater's target when the moves so far are done, or at once. Raises CommandError
        where the power supply is off."""
        if celsius > 0:
            self.mains.require()
        self.cooled_c.pop(heater, None)
        if at_once:
            self.connection.set_target(heater, celsius)
            return
        self.drive.before_moves()
        self.job.mark(self.heaters.index(heater), round(celsius * 100))
        self.drive.after_moves()

    def switch_off(self, heaters: Iterable[str]) -> None:
        """Switches these heaters off at once, and again after the moves so far: a target that is
        still queued among them does not heat for longer than they take."""
        for name in heaters:
            self.set_target(name, 0.0, at_once=True)
            self.set_target(name, 0.0)

    def set_fan(self, fan: str, share: float) -> None:
        """Sets a fan's speed, 0 to 1, when the moves so far are done."""
        self.drive.before_moves()
        self.commands.set_output(fan, share)
        self.drive.after_moves()

    def go_on(self) -> None:
        """M108: ends the wait that goes on, for moves, time, temperatures or a person. Moves go
        on. Where nothing waits but a file whose pause asks somebody, that goes on."""
        waited = self.waits.busy
        self.drive.skip_dwell()
        self.end_wait()
        if not waited:
            self.end_asking()

    def end_wait(self) -> None:
        """Whoever waits waits no more. What moves goes on, dwells too."""
        self.waits.end()

    @property
    def heating(self) -> bool:
        """Somebody waits for a temperature."""
        return self.waits.heating

    def halt(self, reason: str) -> None:
        """M112: heaters, motors and everything else off at once, until M999."""
        self.life.stop()
        if self.halted:
            return
        self.halted = reason.rstrip(".")
        self.failures += 1
        self.cooled_c.clear()
        self.connection.switch_heaters_off()
        self.connection.emergency_stop()
        self.drive.await_answer()

    @property
    def why_halted(self) -> str:
        """`halted`, and what to do."""
        said = self.halted.endswith("M999")
        return self.halted if said else f"{self.halted}. Make the printer safe, then send M999"

    def revive(self) -> None:
        """M999: a halted printer begins anew, cold, and without knowing where it is."""
        if self.halted:
            self.life.revive()

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
        """A switch was hit in mid-move: brakes, and ends the print if one is under way, with all
        heaters off. A host that prints is asked to pause."""
        self.stop_all(f"endstop {', '.join(names)} was triggered")
        if not self.halted:
            self.switch_off(self.heaters)
            self.tell("echo:Heaters are off: an endstop was triggered during a move (M540)")
            self.tell("// action:pause")

    def stop_all(self, reason: str) -> None:
        """M410: brakes to a stop on the path and forgets all moves that were planned. A print that
        moves the machine ends: what is left of it would not follow on. A halted machine has stopped
        already."""
        if self.halted:
            return
        self.stop()
        for listener in self.stop_listeners:
            listener(reason)

    def stop(self) -> None:
        """Brakes to a stop on the path and forgets all moves that were planned."""
        self.drive.stop()
        self.commands.plan_forgotten()
        self.commands.follow_tool()
        self.cooled_c.clear()
        self.beeper.forget()
        self.laser_off()
        self.waits.ended = True

    def laser_off(self) -> None:
        """The laser goes off when the moves so far are done, until it is switched on again."""
        if self.machine.laser and not self.halted:
            self.drive.before_moves()
            self.commands.laser_off()
            self.drive.after_moves()

    @contextmanager
    def dark(self) -> Generator[None]:
        """The laser is off when the moves so far are done, and as it was at the end, unless it was
        switched off for good meanwhile."""
        if self.commands.lit and not self._shaded:
            self._shade(dark=True)
        try:
            yield
        finally:
            self._unshade()

    def _unshade(self) -> None:
        if self._shaded and not (self.halted or self.job.suspended):
            self._shade(dark=False)

    def _shade(self, *, dark: bool) -> None:
        self._shaded = dark
        self.drive.before_moves()
        self.commands.shade(dark=dark)
        self.drive.after_moves()

    def suspend_job(self) -> None:
        """Brakes to a stop on the path and puts what is left aside: other moves may come first."""
        self.drive.hold()
        self.job.suspend()
        self.motion.put_aside()
        self._stopped_tool = self.job.tool
        self.commands.follow_tool()

    def take_stopped_tool(self) -> None:
        """The tool whose moves stand aside is in use, whatever was selected meanwhile."""
        self.job.use_tool(self._stopped_tool)
        self.commands.tool_changed(self._stopped_tool)

    def resume_job(self) -> None:
        """Goes on with what was suspended, the machine being back at its stop position."""
        self.drive.before_moves()
        self.motion.take_back()
        self.job.resume()
        self.commands.follow_tool()
        self.drive.after_moves()
        self._unshade()

    # -- commands ---------------------------------------------------------------------------------

    def act(self, command: Command, reply: Reply) -> bool:
        """Carries out a command that acts at once when it comes from there; else False."""
        handler = self.immediate.get(command.code)
        in_order = command.code in self.motion.beside_only and not self.beside(reply)
        if in_order or (handler is None and not forced(command)):
            return False
        if not alone(command):
            return False  # they take their places
        handler = handler or self.planned.get(command.code)
        self._carried_out(handler, command, reply)
        return True

    def has_room(self) -> bool:
        """A planned line can be taken in without a wait, by whoever has the turn."""
        lost = self.drive.interrupted and not self.halted  # what is held comes first
        if self.aside or lost or not self.job.at_boundary:
            return False
        # Beside a print the plan is always full: a line comes behind what is planned.
        return self.job.queued <= MOST_QUEUED if self.busy() else not self.drive.full

    def answers_halted(self, code: str) -> bool:
        """A halted printer carries such a command out: it acts at once, and not on the plan. What
        has halted it is not rearmed; M999 begins anew, cold."""
        return code in self.immediate and code not in self.motion.immediate and code != "M922"

    def beside(self, reply: Reply) -> bool:
        """Who asks is not the one whose moves are planned: a console beside a print from the card,
        or beside another console."""
        return reply is not self.program

    def select(self, *, console: bool) -> None:
        """What is read next comes from a console, or else from the file."""
        self._from_console = console
        self.job.select(console)
        self.heat.guard_extrusion()

    @property
    def in_console_line(self) -> bool:
        """A line of a console is under way, none of the file."""
        return self._from_console and not self.job.at_boundary

    @contextmanager
    def file_selected(self) -> Generator[_core.Job]:
        """The job with the file's text selected: to ask or restart it, not to read on, while a line
        of a console may be under way."""
        self.job.select(False)
        try:
            yield self.job
        finally:
            self.job.select(self._from_console)

    def take_line(self, text: str, reply: Reply) -> Wait | None:
        """Takes in one line of a console: all of it, or up to a command that waits; then `finish`
        goes on. Only with the turn and with room."""
        self._tell_of_line(done=False)
        self.select(console=True)
        job = self.job
        job.feed(text.encode("utf-8", "surrogateescape") + b"\n")
        before = job.queued, job.clock
        wait = self._go_on(reply)
        self._tell_of_line(done=True)
        if not self.busy() and (job.queued, job.clock) != before:
            self.program = reply
        return wait

    def take_setting(self, text: str, reply: Reply) -> None:
        """Carries out one line of stored settings, the machine standing, by who has the turn."""
        self.select(console=True)
        self.job.feed(text.encode("utf-8", "surrogateescape") + b"\n")
        wait = self._go_on(reply)
        while wait is not None:
            if isinstance(wait, Still) and wait.then is not None:
                self.drive.flush()
                wait.then()
            wait = self._go_on(reply)

    async def room(self) -> bool:
        """Waits, with the turn, until a planned line can be taken in. True if M108 came meanwhile:
        then it is taken even if the plan is full, and its own wait is over."""
        return await self.waits.room(self.has_room)

    async def finish(
        self,
        wait: Wait | None,
        reply: Reply,
        *,
        first_ends: bool = False,
        all_end: Callable[[], bool] = lambda: False,
    ) -> None:
        """The rest of a line whose command waits; its first wait, or all of them, may have to end
        as soon as they begin. Raises Stopped or MachineError."""
        try:
            while wait is not None:
                await self.waits.wait(wait, reply, ends=first_ends or all_end())
                if isinstance(wait, Person) and all_end():
                    raise Stopped("no user has confirmed it")
                first_ends = False
                self.select(console=True)
                wait = self._go_on(reply)
                self._tell_of_line(done=True)
        except Exception:
            self.job.abandon()  # the rest of the line would stand in everybody's way
            raise

    def _tell_of_line(self, *, done: bool) -> None:
        for listener in self.line_listeners:
            listener(done)

    def _carried_out(self, handler: Handler | None, command: Command, reply: Reply) -> Wait | None:
        """By a handler of a living printer, or as in a print without consoles."""
        try:
            if handler is None:
                wait = self.commands.run(command)
            else:
                command.check()
                wait = handler(command, reply)
        except (CommandError, LinkLostError) as error:
            reply.fail(str(error), error.problems)
            return None
        for listener in self.command_listeners:
            listener(command, reply)
        return wait

    def run_command(self, command: Command, reply: Reply) -> Wait | None:
        """Carries out a command that the interpreter handed out."""
        self.drive.before_moves()
        handler = self.planned.get(command.code) or self.immediate.get(command.code)
        if handler is not None and command.code in _IN_THEIR_TURN and not self._from_console:
            return Still(partial(self._carried_out, handler, command, reply))
        wait = self._carried_out(handler, command, reply)
        if self._from_console and (problem := unfit(command, self.skips)):
            levels = problem.code == "input.no-levelling"
            reply.fail(problem.sentence if levels else f'Unknown command: "{command.code}"')
            return wait
        if handler is None:
            self._note(command.code, reply)
        if handler is None and not self.commands.knows(command):
            reply.say(f'echo:Unknown command: "{command.code}"')
        return wait

    def _note(self, code: str, reply: Reply) -> None:
        """Says of a command that does nothing why it does not."""
        row = row_of(code)
        if row is not None and row.kind in (Kind.QUIET, Kind.SERVED, Kind.NOT_BUILT):
            reply.note(row.code, f"{row.code} does nothing here. {row.lacks or row.text}")

    @property
    def interrupted(self) -> bool:
        """Somebody wants the wait that goes on to end: M108, M410 or a halt."""
        return self.waits.ended or bool(self.halted)

    def raise_if_interrupted(self) -> None:
        """Raises Stopped after M108, M410 or a halt."""
        self.raise_if_halted()
        if self.waits.ended:
            raise Stopped("it was stopped")

    def raise_if_halted(self) -> None:
        """Raises Stopped while the machine is halted."""
        if self.halted:
            raise Stopped(self.halted)

    async def run(self) -> None:
        """Keeps the printer alive until cancelled. A failed board halts it, until it is revived."""
        await self.life.run()

    def _heater_failed(self, _: str, fault: HeaterFault) -> None:
        """A protection has switched a heater off; how much more stops is the heater's policy."""
        self.failures += 1
        policy = self.machine.heaters[fault.heater].on_fault
        if policy == "machine":
            self.halt(fault.halting)
            return
        self.tell(f"echo:{fault}")
        if policy == "job":
            target = self.connection.heaters[fault.heater].target
            if target > 0:
                self.cooled_c[fault.heater] = target  # what is printed waits until it is warm again
            for listener in self.fault_listeners:
                listener(fault)

    # -- within -----------------------------------------------------------------------------------

    def _halt_by_line(self, _: Command, __: Reply) -> Wait | None:
        """M112 where no console has seen it come: in a file, or behind another command."""
        self.halt("emergency stop by M112")
        return None

    def _stop_by_line(self, _: Command, __: Reply) -> Wait | None:
        self.stop_all("M410")
        return None

    def _mark_reached(self, target: int, value: int) -> None:
        """A heater's target in 1/100 C, or a tone."""
        if target < len(self.heaters):
            self.connection.set_target(self.heaters[target], value / 100)
        else:
            self.beeper.mark_reached(value)

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
                    problem = self.commands.problem()
                    reply.fail(str(problem), [problem])
                    self.job.abandon()
                    return None
                else:
                    return Room() if found == status.FULL else None
        except Exception:
            self.job.abandon()
            raise
        finally:
            self.drive.after_moves()
