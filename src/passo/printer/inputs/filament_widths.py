"""The sensor of the filament's width of a running printer, which corrects the flow, and its
commands: M404 to M407 and those of Klipper."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from passo.config.filament_width import FULL_SCALE
from passo.config.inputs import width_inputs
from passo.gcode.command import Command, numeral
from passo.gcode.parameters import number
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.status import FilamentSensorStatus
from passo.printer.wait_requests import Reply

if TYPE_CHECKING:
    from passo.printer.inputs.filament_sensors import FilamentSensors, Sensor
    from passo.printer.inputs.inputs import Inputs
    from passo.printer.live_rig import LiveRig
    from passo.printer.state import State

_LACKS = "The machine file has no sensor of the filament's width."
_NO_FILAMENT_MM = 0.5  # below this diameter, the place in the sensor is empty
_CHANGE = 0.001  # the flow changes if its factor does by more than this
_MM_OF_CM = 10.0


class FilamentWidths:
    """The width sensor of one printer. The mean diameter of each interval of filament waits until
    this filament is in the nozzle; the moves from there on, which the board does not have yet, get
    the new factor. An interval with a diameter that differs too much counts as nominal. M221 keeps
    its own value."""

    def __init__(
        self, rig: LiveRig, state: State, inputs: Inputs, sensors: FilamentSensors, sensor: Sensor
    ) -> None:
        assert sensor.config.width is not None
        self._rig, self._state = rig, state
        self._inputs, self._sensors, self._sensor = inputs, sensors, sensor
        self._config = sensor.config.width
        self._pins = list(width_inputs(sensor.name, sensor.config))
        extruders = list(rig.machine.extruders)
        self._extruder = extruders.index(sensor.config.extruder or extruders[0])
        self.nominal_mm, self.distance_mm = self._config.nominal_mm, self._config.distance_mm
        self.measures, self.corrects = self._config.measures, self._config.corrects_flow
        self.logs = self._config.logs
        self.diameter_mm: float | None = None  # of the filament in the sensor
        self._level: tuple[bool, float] | None = None  # whether there is filament, and since when
        self._queue: deque[tuple[float, float]] = deque()  # filament at the nozzle, diameter
        self._nozzle_mm: float | None = None  # diameter of the filament in the nozzle
        self._begin_mm: float | None = None  # filament at the sensor where the interval began
        self._sum_mm, self._count, self._sound = 0.0, 0, True

    # -- what it measures -------------------------------------------------------------------------

    @property
    def readings(self) -> list[float]:
        """The readings of the analog inputs, none before the first report of all."""
        shares = [self._inputs.shares.get(name) for name in self._pins]
        return [FULL_SCALE * share for share in shares if share is not None]

    def time_passed(self) -> None:
        """Takes the readings. Call this often."""
        readings = self.readings
        if len(readings) < len(self._pins):
            return
        self.diameter_mm = self._config.diameter_mm(sum(readings))
        if not self.measures:
            return
        self._detect(self.diameter_mm)
        if self.diameter_mm < _NO_FILAMENT_MM:
            self._forget()
        else:
            self._measure(self.diameter_mm)
        self._correct()

    def _detect(self, diameter_mm: float) -> None:
        most = self._config.max_mm or self.nominal_mm + self._config.max_difference_mm
        level = self._config.min_mm <= diameter_mm <= most
        now_s = self._rig.queue.passed / self._rig.queue.hz
        if self._level is None or self._level[0] != level:
            self._level = level, now_s
        if now_s - self._level[1] >= self._sensor.config.debounce_s:
            self._sensors.detect(self._sensor, level, first=self._sensor.detected is None)

    def _measure(self, diameter_mm: float) -> None:
        at_mm = self._sensors.pushed_mm(self._sensor)
        self._sum_mm, self._count = self._sum_mm + diameter_mm, self._count + 1
        self._sound = self._sound and self._is_sound(diameter_mm)
        if self._begin_mm is None or at_mm >= self._begin_mm + self._config.interval_mm:
            begin_mm = at_mm if self._begin_mm is None else self._begin_mm
            mean_mm = self._sum_mm / self._count
            used_mm = mean_mm if self._sound else self.nominal_mm
            self._queue.append((begin_mm + self.distance_mm, used_mm))
            self._begin_mm, self._sum_mm, self._count, self._sound = at_mm, 0.0, 0, True
            if self.logs:
                self._state.tell(f"// Filament width: {mean_mm:.3f} mm")

    def _correct(self) -> None:
        """Sets the factor of the moves that the board does not have yet."""
        job, queue = self._rig.job, self._rig.queue
        nozzle_mm = job.history.filament_at(queue.first_changeable, self._extruder)
        while self._queue and self._queue[0][0] <= nozzle_mm:
            _, self._nozzle_mm = self._queue.popleft()
        factor, now = self.factor, job.filament.width_factors[self._extruder]
        if abs(factor / now - 1) > _CHANGE or (factor == 1 and now != 1):
            queue.scale_width(self._extruder, factor)

    @property
    def factor(self) -> float:
        """The factor of the flow for the filament in the nozzle."""
        used_mm = self._nozzle_mm
        if used_mm is None and self._config.corrects_at_once:
            used_mm = self.diameter_mm
        if not (self.measures and self.corrects) or used_mm is None or not self._is_sound(used_mm):
            return 1.0
        return (self.nominal_mm / used_mm) ** 2

    def _is_sound(self, diameter_mm: float) -> bool:
        return abs(diameter_mm - self.nominal_mm) <= self._config.max_difference_mm

    def status(
        self, sensors: Mapping[str, FilamentSensorStatus]
    ) -> dict[str, FilamentSensorStatus]:
        """Its status, with what it measures."""
        name = self._sensor.name
        measured = replace(
            sensors[name],
            diameter_mm=self.diameter_mm,
            reading=sum(self.readings),
            measures=self.measures,
            flow_factor=self.factor,
        )
        return {name: measured}

    def _forget(self) -> None:
        self._queue.clear()
        self._nozzle_mm = self._begin_mm = None
        self._sum_mm, self._count, self._sound = 0.0, 0, True

    def reset(self) -> None:
        """Call this after the boards have restarted: no filament has been pushed yet."""
        self._forget()

    # -- commands ---------------------------------------------------------------------------------

    @command(
        "M404",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Sets the nominal diameter of the filament that the width sensor measures; without"
        " parameters it reports it. Marlin's letter is W, RepRapFirmware's is N.",
        number("W", "the nominal diameter", "mm", 1, 5),
        number("N", "the nominal diameter", "mm", 1, 5),
        kind=Kind.QUIET,
        lacks=_LACKS,
        in_turn=True,
    )
    def _nominal(self, command: Command, reply: Reply) -> None:
        if not command.values:
            reply.say(f"echo:Filament dia (nominal mm): {numeral(self.nominal_mm)}")
        self.nominal_mm = command.value("W", command.value("N", self.nominal_mm))

    @command(
        "M405",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Lets the width sensor measure, and correct the flow. D is the filament from the sensor to"
        " the nozzle, in cm as in Marlin.",
        number("D", "the filament from the sensor to the nozzle", "cm", 0.1, 500),
        kind=Kind.QUIET,
        lacks=_LACKS,
        in_turn=True,
    )
    @command(
        "ENABLE_FILAMENT_WIDTH_SENSOR",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Like M405. FLOW_COMPENSATION sets whether the flow follows the width.",
        number("FLOW_COMPENSATION", "1: the flow follows the width, 0: it does not"),
        kind=Kind.QUIET,
        lacks=_LACKS,
        in_turn=True,
    )
    def _on(self, command: Command, reply: Reply) -> None:
        if command.has("D"):
            self.distance_mm = _MM_OF_CM * command.value("D")
            self._forget()
        self.corrects = command.value("FLOW_COMPENSATION", float(self.corrects)) != 0
        self.measures = True
        self._correct()
        reply.say("// Filament width sensor: ON")

    @command(
        "M406",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Ends the measurement of the width sensor, and its correction of the flow.",
        kind=Kind.QUIET,
        lacks=_LACKS,
        in_turn=True,
    )
    @command(
        "DISABLE_FILAMENT_WIDTH_SENSOR",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Like M406.",
        kind=Kind.QUIET,
        lacks=_LACKS,
        in_turn=True,
    )
    def _off(self, _: Command, reply: Reply) -> None:
        self.measures, self._level = False, None
        self._sensors.detect(self._sensor, True, first=True)
        self._forget()
        self._correct()
        reply.say("// Filament width sensor: OFF")

    @command(
        "M407",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Reports the diameter of the filament in the width sensor.",
        kind=Kind.QUIET,
        lacks=_LACKS,
    )
    @command(
        "QUERY_FILAMENT_WIDTH",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Like M407.",
        kind=Kind.QUIET,
        lacks=_LACKS,
    )
    def _query(self, _: Command, reply: Reply) -> None:
        present = "present" if self._sensor.detected else "not present"
        if self.diameter_mm is not None:
            reply.say(f"// Filament dia (measured mm): {self.diameter_mm:.3f}, {present}")
        on = "ON" if self.measures else "OFF"
        reply.say(f"// Width sensor: {on}, flow factor of the width: {self.factor:.4f}")

    @command(
        "QUERY_RAW_FILAMENT_WIDTH",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Reports the readings of the width sensor, to calibrate it.",
        kind=Kind.QUIET,
        lacks=_LACKS,
    )
    def _raw(self, _: Command, reply: Reply) -> None:
        readings = self.readings
        words = [f"ADC{i}={value:.0f}" for i, value in enumerate(readings, 1)]
        reply.say(f"// {' '.join(words)} RAW={sum(readings):.0f}")

    @command(
        "RESET_FILAMENT_WIDTH_SENSOR",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Forgets what the width sensor has measured. The flow is that of M221 until filament that"
        " is measured from now on arrives in the nozzle.",
        kind=Kind.QUIET,
        lacks=_LACKS,
        in_turn=True,
    )
    def _clear(self, _: Command, reply: Reply) -> None:
        self._forget()
        self._correct()
        reply.say("// Filament width measurements cleared")

    @command(
        "ENABLE_FILAMENT_WIDTH_LOG",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Reports each measured diameter from now on.",
        kind=Kind.QUIET,
        lacks=_LACKS,
        in_turn=True,
    )
    def _log_on(self, _: Command, reply: Reply) -> None:
        self.logs = True
        reply.say("// Filament width log: ON")

    @command(
        "DISABLE_FILAMENT_WIDTH_LOG",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Ends the reports of ENABLE_FILAMENT_WIDTH_LOG.",
        kind=Kind.QUIET,
        lacks=_LACKS,
        in_turn=True,
    )
    def _log_off(self, _: Command, reply: Reply) -> None:
        self.logs = False
        reply.say("// Filament width log: OFF")
