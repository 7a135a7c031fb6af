"""Reads the typed status of a printer, once for all readers."""

from __future__ import annotations

import json
from dataclasses import replace
from math import hypot
from typing import TYPE_CHECKING

from passo.motion.axis_slots import E, slot_of_axis
from passo.printer.fault_status import faults_of
from passo.printer.status import (
    AxisStatus,
    BoardStatus,
    HeaterStatus,
    MotionStatus,
    PrinterState,
    RetractionStatus,
    Status,
)

if TYPE_CHECKING:
    from passo.board.connection import Connection
    from passo.printer.control import Control
    from passo.printer.live_rig import LiveRig
    from passo.printer.machine_parts import MachineParts

_SPEED_OVER_S = 0.02  # the current speed is the mean over this time


class StatusReader:
    """Reads the status of one printer, without asking a board and without letting time pass. The
    print, the queue and the stored settings add their fields: see `State.status_parts`."""

    def __init__(self, control: Control, parts: MachineParts) -> None:
        self._control, self._rig, self._state = control, control.rig, control.state
        self._outputs, self._heat, self._levelling = parts.outputs, parts.heat, parts.levelling
        self._offsets, self._inputs = parts.motion.offsets, parts.inputs
        self._sensors, self._tachometers = parts.sensors, parts.tachometers
        self._axis_names = self._rig.machine.moved_axes
        self._moves_since_s: float | None = None

    def read(self) -> Status:
        """The current status."""
        rig, job = self._rig, self._rig.job
        names = {*self._axis_names.values(), "e"}
        positions = {k.lower(): mm for k, mm in rig.positions.shown().items()}
        shown = {name: mm for name, mm in positions.items() if name in names}
        homed = _homed_axes(rig)
        status = Status(
            state=self._printer_state(),
            halted=self._state.halted,
            time_s=max(rig.queue.now_s, 0.0),
            position_mm=shown,
            homed=homed,
            tool=job.tool,
            heaters={name: self._heater(name) for name in rig.machine.heaters},
            fans={n: rig.commands.outputs.fans.get(n, 0.0) for n in rig.machine.fans},
            speed_factor=job.limits.speed_factor,
            motion=self._motion(),
            axes=self._axes(shown, homed),
            boards=self._boards(),
            flow_factors=list(job.filament.flows),
            faults=faults_of(self._state.cause.problems) if self._state.cause else (),
            link=self._control.supervisor.link.name.lower(),
            message=self._control.prompts.message,
            question=self._control.prompts.question,
            power_supply=self._outputs.power.on,
            started=self._state.start_failure is None,
            macros=json.loads(json.dumps(rig.macros.variables)),  # with texts as keys
            min_extrude_c=self._heat.settings.cold.min_c(job.tool),
            saved_variables=rig.macros.saved,
            bed=self._levelling.bed.status() if rig.machine.probe else None,
            skew_profile=self._levelling.skew.profile_status if self._levelling.skew else None,
            gantry_level=self._levelling.gantry.level if self._levelling.gantry else None,
            screws=self._levelling.screws.measured if self._levelling.screws else (),
            screws_limit_mm=self._levelling.screws.exceeded_mm if self._levelling.screws else None,
            shapers=rig.commands.filters.shaper_status(),
            advances=rig.commands.filters.advance_status(),
            retraction=RetractionStatus.of(job) if rig.machine.extruders else None,
            cooled_c=dict(self._outputs.targets.cooled_c),
            outputs=self._output_values(),
            servos_us=self._servo_widths(),
            fan_rpm=self._tachometers.status(),
            lights={n: tuple(c) for n, c in rig.commands.lights.colors.items()}
            | self._outputs.lights.effects.shown,
            fan_targets_c=dict(rig.commands.fan_targets.targets_c),
            sensors=self._sensors.status(),
            filament_sensors=self._inputs.filament_status(),
            buttons={n: self._inputs.buttons.pressed.get(n, False) for n in rig.machine.buttons},
            inputs=self._inputs.inputs.status(),
        )
        for add in self._state.status_parts:
            status = add(status)
        return replace(status, moving_s=self._moving_s(status.state, status.time_s))

    def _output_values(self) -> dict[str, float]:
        """The values of the outputs; a halted board has switched them to `at_halt`."""
        values = self._rig.commands.outputs.values
        if not self._state.halted:
            return dict(values)
        return {name: self._rig.machine.outputs[name].at_halt for name in values}

    def _servo_widths(self) -> dict[str, float]:
        """The lengths of the pulses of the servos; a halted board sends none."""
        widths = self._rig.commands.servos.widths_us
        return dict.fromkeys(widths, 0.0) if self._state.halted else dict(widths)

    def _moving_s(self, state: PrinterState, now_s: float) -> float:
        """The print time since the machine began to print or move without a break; `now_s` is the
        print time now."""
        if state not in (PrinterState.PRINTING, PrinterState.BUSY):
            self._moves_since_s = None
            return 0.0
        if self._moves_since_s is None:
            self._moves_since_s = now_s
        return now_s - self._moves_since_s

    def _printer_state(self) -> PrinterState:
        rig = self._rig
        if self._state.halted:
            return PrinterState.HALTED
        busy = self._control.motion_lock.locked or not rig.queue.idle
        return PrinterState.BUSY if busy else PrinterState.IDLE

    def _motion(self) -> MotionStatus:
        rig = self._rig
        nozzle, filament = self._speeds()
        return MotionStatus.of(
            rig.job,
            speed_mm_s=nozzle,
            filament_mm_s=filament,
            queued_s=max(rig.queue.ahead_s, 0.0),
            motors_on=bool(self._outputs.motors.on),
        )

    def _speeds(self) -> tuple[float, float]:
        """Speeds of the nozzle and of the filament, mm/s; a retraction is negative."""
        rig, job = self._rig, self._rig.job
        now = rig.queue.passed
        if self._state.halted or rig.queue.idle:
            return 0.0, 0.0
        then = now - int(_SPEED_OVER_S * rig.queue.hz)
        to, start = job.history.position_at(now), job.history.position_at(then)
        if to is None or start is None:
            return 0.0, 0.0
        moved = [(a - b) / _SPEED_OVER_S for a, b in zip(to, start, strict=True)]
        return hypot(*moved[:3]), moved[E]

    def _axes(self, shown: dict[str, float], homed: frozenset[str]) -> dict[str, AxisStatus]:
        rig, job = self._rig, self._rig.job
        program, machine = rig.positions.program, job.machine_position
        steps = self._offsets.babysteps_mm
        found: dict[str, AxisStatus] = {}
        for i, name in self._axis_names.items():
            axis = rig.machine.axes[name]
            shift = machine[slot_of_axis(i)] - program[i]
            found[name] = AxisStatus(
                position_mm=shown[name],
                machine_mm=shown[name] + shift,
                homed=name in homed,
                min_mm=axis.min_mm,
                max_mm=axis.max_mm,
                babystep_mm=steps.get(name, 0.0),
            )
        return found

    def _heater(self, name: str) -> HeaterStatus:
        rig = self._rig
        """The status of a heater of this name."""
        heater = rig.connection.heaters[name]
        reading = rig.connection.reading(name, rig.queue.board_now)
        return HeaterStatus(
            reading.celsius,
            heater.target,
            # The board's last report of a heater is older than the halt.
            0.0 if self._state.halted or heater.fault else heater.power,
            heater.fault.kind.name.lower().replace("_", "-") if heater.fault else "",
            self._heat.settings.cold.min_c_of(name),
            reading.age_s,
        )

    def _boards(self) -> dict[str, BoardStatus]:
        live, connections = (
            self._rig.connection.live,
            self._rig.connection.connections,
        )
        return {
            connection.name or "main": _board_status(connection, simulated=not live)
            for connection in connections
        }


def _board_status(connection: Connection, *, simulated: bool) -> BoardStatus:
    load = connection.main_loop()
    return BoardStatus(
        firmware=connection.dictionary.version,
        mcu=str(connection.dictionary.constants.get("MCU", "")),
        clock_hz=float(connection.board.clock_hz),
        simulated=simulated,
        bytes_sent=connection.link.wire_bytes,
        bytes_resent=connection.link.retransmitted_bytes,
        awake_s=None if load is None else load.awake_s,
        task_s=None if load is None else load.mean_s,
        task_deviation_s=None if load is None else load.deviation_s,
    )


def _homed_axes(rig: LiveRig) -> frozenset[str]:
    """The axes that may move: the homed ones, or all on a machine that does not require homing."""
    locked = rig.job.locked_axes
    return frozenset(name for i, name in rig.machine.moved_axes.items() if i not in locked)
