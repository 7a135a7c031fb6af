"""One printer: builds its parts, restarts them after a halt, and handles stops."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING

from passo.errors import MachineError, PassoError
from passo.gcode.command import Command
from passo.gcode.registry import in_program
from passo.geometry.skewable import SkewableModel
from passo.motion.bed_correction import BedCorrection
from passo.motion.endstops import homed_axes
from passo.motion.homing import Homer
from passo.motion.lone_motors import LoneMotors
from passo.motion.offsets import Offsets
from passo.motion.predefined_moves import PredefinedMoves
from passo.motion.probing import Prober
from passo.motion.resonance_test import ResonanceTest
from passo.motion.triggered_moves import TriggeredMoves
from passo.printer.commands.bed_correction import BedCorrectionCommands
from passo.printer.commands.bed_screws import ScrewCommands
from passo.printer.commands.beeper import Beeper
from passo.printer.commands.delta_calibration import DeltaCommands, is_calibrated
from passo.printer.commands.drivers import DriverCommands
from passo.printer.commands.endstop_offsets import EndstopCommands
from passo.printer.commands.heater_control import ControlCommands
from passo.printer.commands.heater_tuning import TuneCommands
from passo.printer.commands.levelling import LevellingCommands
from passo.printer.commands.manual_probe import ManualProbe
from passo.printer.commands.motor_moves import MotorMoves
from passo.printer.commands.motors import Motors
from passo.printer.commands.power_supply import PowerSupply
from passo.printer.commands.predefined_moves import PredefinedMoveCommands
from passo.printer.commands.probe_deployment import ProbeDeploymentCommands
from passo.printer.commands.probe_moves import ProbeMoveCommands
from passo.printer.commands.probe_offsets import ProbeOffsetCommands
from passo.printer.commands.probing import ProbeCommands
from passo.printer.commands.resonance import ResonanceCommands
from passo.printer.commands.simulated_faults import SimulatedFaultCommands
from passo.printer.commands.skew import SkewCommands
from passo.printer.commands.steps_and_offsets import MotionCommands
from passo.printer.commands.temperature import HeatCommands
from passo.printer.commands.user_prompts import UserPrompts
from passo.printer.commands.z_motors import EndstopOffsets, ZMotorCommands, has_endstops
from passo.printer.dispatch import Dispatch
from passo.printer.laser import Laser
from passo.printer.live_rig import LiveRig
from passo.printer.motion_lock import MotionLock
from passo.printer.recovery.reconnect import Reconnection
from passo.printer.recovery.supervisor import Supervisor
from passo.printer.setup.boards import connect, reconnected
from passo.printer.state import State
from passo.printer.targets import Targets
from passo.printer.unfit_commands import NOTHING, Skips
from passo.printer.wait_requests import NullReply, Reply, Wait
from passo.printer.wait_runner import WaitRunner
from passo.printer.watch.automatic_fans import AutomaticFans
from passo.printer.watch.driver_status import DriverWatch
from passo.printer.watch.endstops import EndstopWatch
from passo.printer.watch.idle_timeout import IdleWatch
from passo.printer.watch.late_commands import LateCommandWatch

if TYPE_CHECKING:
    from passo import _core
    from passo.board.boards import Boards
    from passo.board.faults import HeaterFault
    from passo.config.machine import MachineConfig
    from passo.motion.motion_queue import MotionQueue
    from passo.motion.positions import Positions
    from passo.printer.commands.program import Commands

_log = logging.getLogger(__name__)

_MAKE_SAFE = "Make the printer safe, then send M999"  # shown after M112
# A broken sensor is detected after two reports, 0.3 s apart; sensors report one after the other.
_FIRST_REPORTS_S, _NEXT_SENSOR_S = 0.6, 0.1


class Printer:
    """A printer that takes commands from several sources. Use it within one event loop. `rig` has
    the parts that M999 replaces. `state` has the state (running, halted, paused) and its listeners.
    `dispatch` passes commands to handlers. Each other part has one subject. `skips` are the
    commands that prints may skip. With `free`, print time passes as fast as possible.
    """

    def __init__(
        self, machine: MachineConfig, *, free: bool = False, skips: Skips = NOTHING
    ) -> None:
        self.machine = machine
        self.skips = skips = skips.on(machine)
        connection, self.board = connect(machine)
        self.rig = rig = LiveRig(machine, free=free)
        self.state = state = State()
        self.motion_lock = MotionLock()
        self.offsets = Offsets(machine)
        self._first_faults: list[HeaterFault] = []
        self._suspended_mm = 0.0  # filament moved while jobs were suspended
        self._stopped_mm: float | None = None  # `filament_mm` when the job was suspended
        self.laser = Laser(rig, state)
        self.targets = Targets(rig, lambda: self.power_supply.require())
        self.motors = Motors(rig, self.laser)
        self.power_supply = PowerSupply(rig, self.laser, self.motors, self.targets)
        self.beeper = Beeper(rig, state)
        self.drivers = DriverWatch(rig, state, self.motors, self.halt)
        self.lateness = LateCommandWatch(rig, state)
        self._begin(connection, first=True)
        self.triggered = TriggeredMoves(rig, state)
        self.correction = BedCorrection(rig, lambda: bool(state.halted))
        self.prober = Prober(rig, state, self.triggered, self.correction)
        lone_motors = LoneMotors(rig, state, self.triggered)
        self.homer = Homer(
            rig,
            state,
            self.offsets,
            lambda: rig.commands.problem(),
            self.triggered,
            self.correction,
            lone_motors,
            self.prober,
        )
        self.endstops = EndstopWatch(rig, state, self.triggered, self.stop_by_endstop)
        self.triggered.starts.append(self.endstops.pause)
        self.prompts = UserPrompts(state, self.beeper)
        self.moves = PredefinedMoves(rig, state, self.triggered, lambda: rig.commands.problem())
        self.move_commands = PredefinedMoveCommands(machine, self.moves)
        self.waits = WaitRunner(
            *(rig, state, self.homer, self.moves, self.prompts, self.laser, self.targets)
        )
        self.controls = ControlCommands(rig)
        self.heat = HeatCommands(rig, self.controls)
        self.motion = MotionCommands(rig, state, self.offsets, self.homer)
        self.driver_commands = DriverCommands(machine, self.drivers, self.motors)
        self.faults = SimulatedFaultCommands(rig, state, free=free)
        self.dispatch = Dispatch(rig, state, self.waits, skips, self.heat.guard_extrusion)
        tunes = TuneCommands(rig, state, self.targets, self.controls)
        self.dispatch.add(self, self.heat, self.motion, self.prompts, self.controls, self.endstops)
        self.dispatch.add(self.faults, self.power_supply, self.motors, tunes, self.driver_commands)
        self.corrections = BedCorrectionCommands(rig, self.correction)
        offsets = ProbeOffsetCommands(
            rig, self.prober, self.correction, self.corrections, self.offsets
        )
        self.manual_probe = ManualProbe(self.prober, self.correction, offsets)
        self.levelling = LevellingCommands(
            *(rig, self.prober, self.correction, self.corrections, offsets, self.manual_probe),
            self.moves,
        )
        if machine.probe is not None:
            self.dispatch.add(ProbeCommands(rig, self.prober), self.levelling, self.corrections)
            self.dispatch.add(ProbeDeploymentCommands(self.prober), offsets, self.manual_probe)
            self.dispatch.add(ProbeMoveCommands(rig, self.prober))
        self.delta = None
        if is_calibrated(machine):
            self.delta = DeltaCommands(rig, self.prober, self.correction, self.manual_probe)
            self.dispatch.add(self.delta, self.manual_probe)
        self.z_endstops = EndstopOffsets(rig) if has_endstops(machine) else None
        self.gantry = self.screws = None
        if machine.levelling.motors is not None and machine.probe is not None:
            self.gantry = ZMotorCommands(
                rig,
                machine.levelling.motors,
                self.prober,
                self.correction,
                self.triggered,
                lone_motors,
                self.z_endstops,
            )
            self.dispatch.add(self.gantry)
        if machine.levelling.screws is not None and machine.probe is not None:
            self.screws = ScrewCommands(machine.levelling.screws, self.prober, self.manual_probe)
            self.dispatch.add(self.screws)
        if self.delta is not None or self.z_endstops is not None:
            self.dispatch.add(EndstopCommands(self.delta, self.z_endstops))
        self.skew = SkewCommands(rig) if isinstance(machine.geometry, SkewableModel) else None
        if self.skew is not None:
            self.dispatch.add(self.skew)
        if machine.accelerometer is not None:
            test = ResonanceTest(
                *(rig, state, self.triggered, self.correction),
                lambda: rig.commands.problem(),
            )
            self.dispatch.add(ResonanceCommands(rig, state, machine.accelerometer, test))
        motor_moves = MotorMoves(rig, state, self.triggered, self.correction, self.homer)
        self.dispatch.add(motor_moves, self.move_commands)
        if machine.beeper is not None:
            self.dispatch.add(self.beeper)
        idle = IdleWatch(
            rig,
            state,
            self.motion_lock,
            motors=self.motors,
            laser=self.laser,
            targets=self.targets,
            prompts=self.prompts,
            waits=self.waits,
            halt=self.halt,
        )
        self.closers: list[Callable[[], None]] = [self.faults.close]  # the last is called first
        self.watchers: list[Callable[[], None]] = [  # called as time passes
            idle.time_passed,
            self.beeper.time_passed,
            self.faults.time_passed,
            self.endstops.time_passed,
            AutomaticFans(rig, state, self.motors).time_passed,
            self.drivers.time_passed,
            self.lateness.time_passed,
        ]
        self.supervisor = Supervisor(
            rig,
            state,
            self.motion_lock,
            self.lateness,
            Reconnection(
                rig,
                state,
                motors=self.motors,
                power_supply=self.power_supply,
                drivers=self.drivers,
                endstops=self.endstops,
            ),
            halt=self.halt,
            restart=self._restart,
        )

    # -- parts of the rig ---------------------------------------------------------------------

    @property
    def connection(self) -> Boards:
        """The boards."""
        return self.rig.connection

    @property
    def job(self) -> _core.Job:
        """The interpreter and the plan."""
        return self.rig.job

    @property
    def queue(self) -> MotionQueue:
        """The motion queue."""
        return self.rig.queue

    @property
    def positions(self) -> Positions:
        """The real position of the machine."""
        return self.rig.positions

    @property
    def commands(self) -> Commands:
        """The commands of the job."""
        return self.rig.commands

    @property
    def halted(self) -> str:
        """The reason why the printer is halted until M999, or empty."""
        return self.state.halted

    def tell(self, text: str) -> None:
        """Sends a line to all consoles."""
        self.state.tell(text)

    # -- start and restart ------------------------------------------------------------------------

    def _begin(self, connection: Boards, *, first: bool) -> None:
        """Starts with newly configured boards and an empty plan. Raises MachineError after
        releasing the boards. At the `first` start, a failed machine is not an error here:
        `report_start` halts the printer later."""
        try:
            self._set_up(connection, first=first)
            if not first:
                self._report_faults()
        except BaseException:
            connection.close()
            raise

    def _set_up(self, connection: Boards, *, first: bool) -> None:
        rig = self.rig
        self._first_faults = []
        self.state.start_failure = None
        self.laser.begin()
        connection.keep_frames()
        if connection.survives:
            connection.arm(True)  # from here on, a late message does not shut a board down
        self.power_supply.begin(connection)
        self.beeper.begin(connection)
        failure = self._first_reports(connection)
        if failure is not None and not first:
            raise failure
        rig.connect(connection)
        connection.set_on_fault(self._heater_failed)
        try:
            self.drivers.begin(connection)
        except MachineError as error:
            if not first:
                raise
            failure = failure or error
        self.state.start_failure = failure
        rig.plan_commands(self.targets, self._mark_reached, self.state.is_other_source)
        rig.queue.on_motion = self._before_motion
        rig.queue.on_pass = self._time_passed
        self._stopped_tool = 0
        self._suspended_mm, self._stopped_mm = 0.0, None
        if connection.adopted:
            # Boards do not report whether the previous host has left motors on. So they are
            # switched off when the machine is idle, and the journal decides about the position.
            self.motors.all_on()
            rig.positions.settle()
        if self.machine.unhomed_moves == "refuse":
            rig.lock(homed_axes(self.machine))

    def _restart(self) -> None:
        """Restarts with the current settings, after M999 or the reset of a board. Raises
        MachineError."""
        state = self.state
        for listener in state.stop_listeners:
            listener(state.halted)
        self.motors.forget()
        lines = list(state.settings())
        self._begin(reconnected(self.rig.connection), first=False)
        self.triggered.begin()
        self.correction.begin()
        self.prober.begin()
        self.manual_probe.begin()
        self.homer.begin()
        self.dispatch.begin()
        self.offsets.restarted()
        self.endstops.begin()
        state.restarted()
        for line in lines:
            self.dispatch.take_setting(line, NullReply())
        ready = "The printer is ready again. Home it before you move it"
        state.announce(_log, logging.INFO, ready)
        if greeting := state.greeting():
            state.tell(greeting)

    def _first_reports(self, connection: Boards) -> MachineError | None:
        """Waits until all sensors have reported. Returns a failure that must halt the machine, or
        None."""
        found: list[HeaterFault] = []
        connection.set_on_fault(lambda _, fault: found.append(fault))
        heaters = self.machine.heaters
        try:
            seconds = _FIRST_REPORTS_S + _NEXT_SENSOR_S * len(heaters)
            connection.run(connection.now + int(seconds * self.machine.board.clock_hz))
        except MachineError as error:
            return error
        halting = [f for f in found if heaters[f.heater].on_fault == "machine"]
        self._first_faults = [fault for fault in found if fault not in halting]
        return MachineError([fault.problem for fault in halting]) if halting else None

    def _report_faults(self) -> None:
        faults, self._first_faults = self._first_faults, []
        for fault in faults:
            self._heater_failed(fault.heater, fault)

    def report_start(self) -> None:
        """Reports failures of the first start, and halts the printer if one of them requires it."""
        self._report_faults()
        if self.state.start_failure is not None:
            self.halt(self.state.start_failure)

    async def run(self) -> None:
        """Runs the printer until cancelled. A failed board halts it until M999."""
        await self.supervisor.run()

    def close(self) -> None:
        """Switches heaters and laser off and releases the boards, then closes all other parts, even
        if one fails. Do not use the printer afterwards."""
        self.queue.close()
        with ExitStack() as last_comes_first:
            for closer in self.closers:
                last_comes_first.callback(closer)
            last_comes_first.callback(self.connection.close)

    # -- what happens as time passes --------------------------------------------------------------

    def _time_passed(self) -> None:
        for watcher in self.watchers:
            watcher()

    def _before_motion(self) -> None:
        if not self.power_supply.on:
            no_power = MachineError.of("machine.no-power")
            self.halt(no_power, no_power.problems[0].sentence)
        self.drivers.before_motion()
        if not self.halted:
            self.motors.all_on()

    def _mark_reached(self, target: int, value: int) -> None:
        """Handles a mark that print time has reached: a heater's target in 1/100 °C, or a tone."""
        if not self.targets.mark_reached(target, value):
            self.beeper.mark_reached(value)

    def _heater_failed(self, _: str, fault: HeaterFault) -> None:
        """Called when a protection has switched a heater off. The policy of the heater decides what
        else stops."""
        self.state.failures += 1
        policy = self.machine.heaters[fault.heater].on_fault
        if policy == "machine":
            self.halt(fault.halting)
            return
        self.state.announce(_log, logging.WARNING, str(fault), fault.problem)
        if policy == "job":
            target = self.connection.heaters[fault.heater].target
            if target > 0:
                self.targets.cooled_c[fault.heater] = target  # the print waits for it
            for listener in self.state.fault_listeners:
                listener(fault)

    # -- stops ------------------------------------------------------------------------------------

    def halt(self, cause: PassoError, reason: str = "") -> None:
        """Switches heaters, motors and all other outputs off at once, until M999. `reason` is
        shown; the default is the text of the cause."""
        self.supervisor.stop()
        if self.state.halted:
            return
        self.state.halt(cause, reason)
        self.targets.plan_forgotten()
        self.connection.switch_heaters_off()
        self.connection.emergency_stop()
        self.queue.await_answer()

    def emergency_stop(self) -> None:
        """M112: halts the printer."""
        stop = MachineError.of("machine.emergency-stop", hint=_MAKE_SAFE)
        self.halt(stop, stop.problems[0].sentence)

    def request_restart(self) -> None:
        """M999: a halted printer restarts, cold and not homed."""
        if self.halted:
            self.supervisor.request_restart()

    def restart(self) -> None:
        """FIRMWARE_RESTART: switches all outputs off at once, then restarts as M999."""
        self.halt(MachineError.of("machine.restart"))
        self.request_restart()

    @in_program("M112")
    def _halt_by_line(self, _: Command, __: Reply) -> Wait | None:
        """M112 that no console has detected, because it is in a file or after another command."""
        self.emergency_stop()
        return None

    @in_program("M410")
    def _stop_by_line(self, _: Command, __: Reply) -> Wait | None:
        self.stop_all("M410")
        return None

    def stop_by_endstop(self, names: Sequence[str]) -> None:
        """Called when an endstop triggers during a move: brakes, ends a running print, and switches
        all heaters off. A host that prints is asked to pause."""
        self.stop_all(f"endstop {', '.join(names)} was triggered")
        if not self.halted:
            self.targets.switch_off()
            off = "Heaters are off: an endstop was triggered during a move (M540)"
            self.state.announce(_log, logging.WARNING, off)
            self.tell("// action:pause")

    def stop_all(self, reason: str) -> None:
        """M410: brakes to a stop on the path and discards all planned moves. A running print ends,
        because it could not continue correctly. Does nothing on a halted machine."""
        if self.halted:
            return
        self.stop()
        for listener in self.state.stop_listeners:
            listener(reason)

    def stop(self) -> None:
        """Brakes to a stop on the path and discards all planned moves."""
        self.queue.stop()
        self.commands.outputs.plan_forgotten()
        self.commands.set_points.follow_tool()
        self.targets.plan_forgotten()
        self.beeper.forget()
        self.laser.off()
        self.state.ended = True

    # -- waits ------------------------------------------------------------------------------------

    def go_on(self) -> None:
        """M108: ends the current wait for moves, time, temperatures or the user. Moves continue. If
        only a paused file waits for the user, the file resumes."""
        waited = self.waits.busy
        self.queue.skip_dwell()
        self.waits.end()
        if not waited:
            self.state.end_asking()

    # -- the suspended job ------------------------------------------------------------------------

    def suspend_job(self, *, hand_over_macro: bool = False) -> None:
        """Brakes to a stop on the path and suspends the rest of the job, so that other moves are
        possible. With `hand_over_macro`, the rest of the file's macro runs during the pause."""
        self.queue.hold()
        self.job.suspend(hand_over_macro)
        self.offsets.suspend()
        self._stopped_tool = self.job.tool
        self._stopped_mm = self.filament_mm()
        self.commands.set_points.follow_tool()

    def take_stopped_tool(self) -> None:
        """Selects the tool of the suspended job again, if another one was selected in the
        meantime."""
        self.job.use_tool(self._stopped_tool)
        self.job.follow_tool()
        self.commands.set_points.tool_changed(self._stopped_tool)

    def resume_job(self) -> None:
        """Resumes the suspended job. The machine must be at its stop position again."""
        self.queue.before_moves()
        if self.job.suspended:
            self.offsets.resume()
        self._end_suspension()
        self.job.resume()
        self.commands.set_points.follow_tool()
        self.queue.after_moves()
        self.laser.end_blanking()

    # -- amounts ----------------------------------------------------------------------------------

    def can_extrude(self) -> bool:
        """Whether the machine has filament, and the active tool's hotend is warm enough to move
        it."""
        return bool(self.machine.extruders) and self.heat.warm()

    def filament_mm(self) -> float:
        """The planned filament of all extruders so far, mm, without moves during the suspension of
        a job."""
        if not self.job.suspended:
            self._end_suspension()
        if self._stopped_mm is not None:
            return self._stopped_mm
        return self._pushed_mm() - self._suspended_mm

    def _pushed_mm(self) -> float:
        return sum(self.job.statistics()["filament_mm"])

    def _end_suspension(self) -> None:
        """Call this when the suspended job has resumed or was discarded."""
        if self._stopped_mm is not None:
            self._suspended_mm = self._pushed_mm() - self._stopped_mm
            self._stopped_mm = None

    def planned_s(self) -> float:
        """Print time of all motion and dwell that was planned so far, seconds."""
        plan = self.job.statistics()
        return plan["move_s"] + plan["dwell_s"]
