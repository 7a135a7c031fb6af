"""One printer: builds its parts, restarts them after a halt, and runs them."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import TYPE_CHECKING

from passo.errors import MachineError
from passo.levelling.mesh_files import MeshStore
from passo.motion.endstops import homed_axes
from passo.printer.commands.driver_registers import DriverRegisterCommands
from passo.printer.commands.drivers import DriverCommands
from passo.printer.commands.servo_numbers import ServoNumbers
from passo.printer.commands.simulated_faults import SimulatedFaultCommands
from passo.printer.commands.stalls import StallCommands
from passo.printer.commands.user_prompts import UserPrompts
from passo.printer.control import Control
from passo.printer.dispatch import Dispatch
from passo.printer.lifetime import Lifetime
from passo.printer.live_rig import LiveRig
from passo.printer.machine_parts import MachineParts
from passo.printer.motion_lock import MotionLock
from passo.printer.print_objects import covered, objects_of
from passo.printer.probe_gcode import ProbeGcode
from passo.printer.recovery.reconnect import Reconnection
from passo.printer.recovery.supervisor import Supervisor
from passo.printer.saved_variables import SavedVariables
from passo.printer.settings import Settings
from passo.printer.setup.connections import connect, reconnected
from passo.printer.setup.heat import build_heat
from passo.printer.setup.inputs import build_inputs
from passo.printer.setup.levelling import build_levelling
from passo.printer.setup.motion import build_motion
from passo.printer.setup.outputs import build_outputs
from passo.printer.state import State
from passo.printer.status_reader import StatusReader
from passo.printer.stops import Stops
from passo.printer.suspension import Suspension
from passo.printer.unfit_commands import NOTHING, Skips
from passo.printer.wait_requests import NullReply
from passo.printer.wait_runner import WaitRunner
from passo.printer.watch.automatic_fans import AutomaticFans
from passo.printer.watch.driver_status import DriverWatch
from passo.printer.watch.endstops import EndstopWatch
from passo.printer.watch.idle_timeout import IdleWatch
from passo.printer.watch.late_commands import LateCommandWatch
from passo.printer.watch.sensors import SensorWatch
from passo.printer.watch.tachometers import Tachometers

if TYPE_CHECKING:
    from passo.board.boards import Boards
    from passo.board.faults import HeaterFault
    from passo.config.machine import MachineConfig
    from passo.levelling.areas import Area

_log = logging.getLogger(__name__)

# A broken sensor is detected after two reports, 0.3 s apart; sensors report one after the other.
_FIRST_REPORTS_S, _NEXT_SENSOR_S = 0.6, 0.1


class Printer:
    """A printer that takes commands from several sources. Use it within one event loop. `rig` has
    the parts that M999 replaces. `state` has the state (running, halted, paused) and its listeners.
    `dispatch` passes commands to handlers, `status` reads the status. Each other part has one
    subject.
    """

    def __init__(
        self,
        machine: MachineConfig,
        *,
        free: bool = False,
        skips: Skips = NOTHING,
        variables: SavedVariables | None = None,
        meshes: MeshStore | None = None,
        printed_area: Callable[[], Area | None] | None = None,
    ) -> None:
        """`skips` are the commands that prints may skip. With `free`, print time passes as fast as
        possible. `variables` are those of SAVE_VARIABLE, `meshes` the stored meshes; by default
        both are empty and kept in memory. `printed_area` gives the area of the bed that the print
        covers, mm; by default that of the objects of the file."""
        self.machine = machine
        self.skips = skips = skips.on(machine)
        connection, self.board = connect(machine)
        self.rig = rig = LiveRig(machine, variables or SavedVariables(), free=free)
        self.state = state = State()
        self.motion_lock = MotionLock()
        self._first_faults: list[HeaterFault] = []
        self.outputs = outputs = build_outputs(rig, state, lambda: self.status.read().progress)
        self.stops = stops = Stops(rig, state, outputs)
        self.drivers = DriverWatch(rig, state, outputs.motors, stops.halt)
        self.lateness = LateCommandWatch(rig, state)
        self.sensors = SensorWatch(rig, state, stops.halt)
        self.tachometers = Tachometers(rig, state, stops.halt)
        self._begin(connection, first=True)
        self.motion = motion = build_motion(rig, state, self.drivers)
        self.heat = heat = build_heat(rig, state, outputs.targets, self.sensors)
        area = printed_area or (lambda: covered(objects_of(rig.job)))
        self.levelling = build_levelling(rig, motion, meshes or MeshStore(), area)
        self.inputs = inputs = build_inputs(rig, state)
        self.suspension = Suspension(rig, motion.offsets, outputs.laser)
        self.endstops = EndstopWatch(rig, state, motion.triggered, stops.stop_by_endstop)
        motion.triggered.starts.append(self.endstops.pause)
        self.prompts = UserPrompts(state, outputs.beeper)
        self.waits = WaitRunner(
            *(rig, state, motion.homer, motion.predefined, self.prompts),
            *(outputs.laser, outputs.targets, self.sensors, heat.report.line),
        )
        self.driver_commands = DriverCommands(machine, self.drivers, outputs.motors)
        registers = DriverRegisterCommands(machine, self.drivers)
        stalls = StallCommands(machine, self.drivers, motion.homer)
        self.settings = Settings(
            *(rig, outputs, motion, heat, self.levelling, inputs.filament),
            *(self.driver_commands, self.prompts, self.endstops, stalls),
        )
        self.faults = SimulatedFaultCommands(rig, state, free=free)
        self.dispatch = Dispatch(rig, state, self.waits, skips, heat.settings.guard_extrusion)
        self.dispatch.add(stops, self.prompts, self.endstops, self.faults)
        self.dispatch.add(self.driver_commands, registers, stalls)
        self.dispatch.add(*outputs.handlers, *heat.handlers, *motion.handlers)
        self.dispatch.add(*self.levelling.handlers, *inputs.handlers)
        if machine.servos or (machine.probe and machine.probe.servo_pin):
            self.dispatch.add(ServoNumbers(rig, motion.prober))
        idle = IdleWatch(
            *(rig, state, self.motion_lock, outputs, self.prompts, self.waits), stops.halt
        )
        self.lifetime = Lifetime()
        self.lifetime.at_end(self.faults.close)
        self.lifetime.as_time_passes(
            idle.time_passed,
            outputs.beeper.time_passed,
            outputs.lights.time_passed,
            self.faults.time_passed,
            self.endstops.time_passed,
            inputs.time_passed,
            AutomaticFans(rig, state, outputs.motors, self.sensors).time_passed,
            self.drivers.time_passed,
            self.sensors.time_passed,
            self.tachometers.time_passed,
            self.lateness.time_passed,
        )
        self.supervisor = supervisor = Supervisor(
            *(rig, state, self.motion_lock, self.lateness),
            Reconnection(rig, state, outputs, self.drivers, self.endstops),
            stops,
            restart=self._restart,
        )
        self.control = Control(
            *(machine, rig, state, self.lifetime, outputs.targets, self.motion_lock, self.prompts),
            *(self.waits, self.dispatch, stops, supervisor, skips),
        )
        self.parts = MachineParts(
            *(outputs, motion, heat, self.levelling, inputs, self.sensors, self.tachometers),
            *(self.suspension, self.settings, self.lateness),
        )
        ProbeGcode(self.control, motion.prober)
        self.status = StatusReader(self.control, self.parts)

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
        self.outputs.laser.reset()
        connection.keep_frames()
        if connection.survives:
            connection.arm(True)  # from here on, a late message does not shut a board down
        self.outputs.power_supply.reset(connection)
        self.outputs.beeper.reset(connection)
        failure = self._first_reports(connection)
        if failure is not None and not first:
            raise failure
        rig.connect(connection)
        connection.set_on_fault(self._heater_failed)
        try:
            self.drivers.set_up(connection)
        except MachineError as error:
            if not first:
                raise
            failure = failure or error
        self.state.start_failure = failure
        rig.plan_commands(
            *(self.outputs.targets, self._mark_reached, self.state.is_other_source),
            lambda: self.status.read(),  # it is built after the first start
            self.outputs.lights,
        )
        rig.commands.outputs.reset(adopted=connection.adopted)
        rig.commands.lights.reset(adopted=connection.adopted)
        rig.commands.servos.reset(adopted=connection.adopted)
        self.outputs.lights.reset(connection)
        rig.queue.on_motion = self._before_motion
        rig.queue.on_pass = self._time_passed
        if connection.adopted:
            # Boards do not report whether the previous host has left motors on. So they are
            # switched off when the machine is idle, and the journal decides about the position.
            self.outputs.motors.all_on()
            rig.positions.settle()
        if self.machine.unhomed_moves == "refuse":
            rig.lock(homed_axes(self.machine))

    def _restart(self) -> None:
        """Restarts with the current settings, after M999 or the reset of a board. Raises
        MachineError."""
        state = self.state
        for listener in state.stop_listeners:
            listener(state.halted)
        self.outputs.motors.forget()
        lines = list(self.settings.lines())
        self._begin(reconnected(self.rig.connection), first=False)
        self.suspension.reset()
        self.motion.reset()
        self.levelling.manual_probe.reset()
        self.dispatch.reset()
        self.endstops.reset()
        self.inputs.reset()
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
            self.stops.halt(self.state.start_failure)

    async def run(self) -> None:
        """Runs the printer until cancelled. A failed board halts it until M999."""
        await self.supervisor.run()

    def close(self) -> None:
        """Switches heaters and laser off and releases the boards, then closes all other parts, even
        if one fails. Do not use the printer afterwards."""
        self.rig.queue.close()
        try:
            self.rig.connection.close()
        finally:
            self.lifetime.end()

    # -- what happens as time passes --------------------------------------------------------------

    def _time_passed(self) -> None:
        self.lifetime.pass_time()

    def _before_motion(self) -> None:
        if not self.outputs.power.on:
            no_power = MachineError.of("machine.no-power")
            self.stops.halt(no_power, no_power.problems[0].sentence)
        self.drivers.before_motion()
        if not self.state.halted:
            self.outputs.motors.all_on()

    def _mark_reached(self, target: int, value: int) -> None:
        """Handles a mark that print time has reached: a heater's target in 1/100 °C, a tone, or the
        colours of a light."""
        if self.outputs.targets.mark_reached(target, value):
            return
        if target == len(self.machine.heaters):
            self.outputs.beeper.mark_reached(value)
        else:
            self.outputs.lights.mark_reached(value)

    def _heater_failed(self, _: str, fault: HeaterFault) -> None:
        """Called when a protection has switched a heater off. The policy of the heater decides what
        else stops."""
        self.state.failures += 1
        policy = self.machine.heaters[fault.heater].on_fault
        if policy == "machine":
            self.stops.halt(fault.halting)
            return
        self.state.announce(_log, logging.WARNING, str(fault), fault.problem)
        if policy == "job":
            target = self.rig.connection.heaters[fault.heater].target
            if target > 0:
                self.outputs.targets.cooled_c[fault.heater] = target  # the print waits for it
            for listener in self.state.fault_listeners:
                listener(fault)
