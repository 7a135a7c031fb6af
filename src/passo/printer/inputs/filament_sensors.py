"""The filament sensors of a running printer: what they detect, and the commands that set them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.config.inputs import sensor_input
from passo.config.part_names import found_name
from passo.errors import CommandError
from passo.gcode.command import Command, numeral
from passo.gcode.parameters import flag, ignored, integer, number, refused, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.stand_ins import FILAMENT_SENSORS
from passo.printer.status import FilamentSensorStatus
from passo.printer.wait_requests import Reply

if TYPE_CHECKING:
    from passo.config.inputs import FilamentSensor
    from passo.printer.inputs.inputs import Inputs
    from passo.printer.live_rig import LiveRig

_LACKS = "The machine file has no filament sensor."
_LONGEST_MM = 5000.0


@dataclass(slots=True)
class Sensor:
    """A filament sensor. `detected` is None until its level is known. `acts` is False after the
    loss of filament has been handled, until filament is detected again. `mm` is the filament that
    the extruder had pushed at the last pulse, or when the filament ended."""

    name: str
    config: FilamentSensor
    enabled: bool
    delay_mm: float
    detected: bool | None
    acts: bool = True
    mm: float = 0.0

    @property
    def moves(self) -> bool:
        """Whether it measures motion."""
        return self.config.kind == "motion"


class FilamentSensors:
    """The filament sensors of one printer, and SET_FILAMENT_SENSOR, QUERY_FILAMENT_SENSOR, M412 and
    M591. They only observe."""

    def __init__(self, rig: LiveRig, inputs: Inputs) -> None:
        self._rig = rig
        self._extruders = list(rig.machine.extruders)
        self.sensors: dict[str, Sensor] = {}
        # called when a sensor detects filament again
        self.insert_listeners: list[Callable[[Sensor], None]] = []
        for name, config in rig.machine.filament_sensors.items():
            motion = config.kind == "motion"
            sensor = Sensor(name, config, config.enabled, config.delay_mm, True if motion else None)
            self.sensors[name] = sensor
            self._listen(inputs, sensor)

    def _listen(self, inputs: Inputs, sensor: Sensor) -> None:
        if sensor.config.width is not None:
            return  # `FilamentWidths` detects its filament
        name = sensor_input(sensor.name)
        if sensor.moves:
            inputs.on_edges(name, lambda _: self._pulse(sensor))
        else:
            inputs.on_level(
                name,
                sensor.config.debounce_s,
                lambda level, first: self.detect(sensor, level, first=first),
            )

    # -- what the sensors detect ------------------------------------------------------------------

    def pushed_mm(self, sensor: Sensor) -> float:
        """The filament that the extruder of a sensor has pushed so far, or that of all
        extruders."""
        job, now = self._rig.job, self._rig.queue.passed
        wanted = sensor.config.extruder
        if wanted is None and sensor.config.kind != "switch":
            wanted = self._extruders[0]
        return sum(
            job.history.filament_at(now, i)
            for i, name in enumerate(self._extruders)
            if wanted in (None, name)
        )

    def _pulse(self, sensor: Sensor) -> None:
        sensor.mm = self.pushed_mm(sensor)
        self.detect(sensor, True, first=False)

    def detect(self, sensor: Sensor, level: bool, *, first: bool) -> None:
        """A sensor detects filament, or not; `first`: its level was not known before."""
        if level == sensor.detected:
            return
        sensor.detected = level
        if not level:
            sensor.mm = self.pushed_mm(sensor)
            return
        sensor.acts = True
        if not first:
            for listener in self.insert_listeners:
                listener(sensor)

    def time_passed(self) -> None:
        """Compares the pulses of motion sensors with the filament that was pushed."""
        for sensor in self.sensors.values():
            if sensor.moves and sensor.detected:
                pushed_mm = self.pushed_mm(sensor)
                if pushed_mm > sensor.mm + sensor.config.length_mm:
                    sensor.detected, sensor.mm = False, pushed_mm

    def compare_from_here(self) -> None:
        """Motion sensors expect their next pulse from here on: call it when a print starts or
        resumes."""
        for sensor in self.sensors.values():
            if sensor.moves:
                sensor.mm = self.pushed_mm(sensor)
                sensor.detected = sensor.acts = True

    def lacking(self) -> list[Sensor]:
        """The enabled sensors of the tool in use that detect no filament, and whose loss has not
        been handled."""
        found = [s for s in self.sensors.values() if s.enabled and s.detected is False and s.acts]
        return [sensor for sensor in found if self._in_use(sensor)]

    def used_up(self, sensor: Sensor) -> bool:
        """Whether the filament between the sensor and the nozzle is used up, too."""
        return self.pushed_mm(sensor) - sensor.mm >= sensor.delay_mm

    def _in_use(self, sensor: Sensor) -> bool:
        wanted = sensor.config.extruder
        if wanted is None and sensor.config.kind == "switch":
            return True
        tool = self._rig.job.history.tool_at(self._rig.queue.passed)
        part = self._rig.machine.all_tools[self._rig.job.tool if tool is None else tool]
        return part.extruder == (self._extruders[0] if wanted is None else wanted)

    def reset(self) -> None:
        """Call this after the boards have restarted: no filament has been pushed yet."""
        for sensor in self.sensors.values():
            sensor.mm = 0.0

    def status(self) -> dict[str, FilamentSensorStatus]:
        """The sensors for the status of the printer."""
        return {
            name: FilamentSensorStatus(bool(s.detected), s.enabled, moves=s.moves)
            for name, s in self.sensors.items()
        }

    # -- commands ---------------------------------------------------------------------------------

    @command(
        "SET_FILAMENT_SENSOR",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Switches a filament sensor on (ENABLE=1) or off (ENABLE=0). DELAY_MM sets the filament"
        " that is used before the print pauses; without ENABLE it does not switch the sensor.",
        text("SENSOR", "the name of the sensor"),
        number("ENABLE", "1: on, 0: off; 1 if there is no DELAY_MM either"),
        number("DELAY_MM", "the filament that is used before the pause", "mm", 0, _LONGEST_MM),
        kind=Kind.QUIET,
        lacks=_LACKS,
        in_turn=True,
    )
    def _set(self, command: Command, _: Reply) -> None:
        on = command.value("ENABLE", 1.0) != 0
        stand_in = self._rig.macros.stand_ins.named(FILAMENT_SENSORS, command.string("SENSOR"))
        if stand_in is not None:
            stand_in["enabled"] = on  # of a section that the machine file keeps for macros
            return
        sensor = self._named(command)
        sensor.delay_mm = command.value("DELAY_MM", sensor.delay_mm)
        if command.has("ENABLE") or not command.has("DELAY_MM"):
            self._enable([sensor], on=on)

    @command(
        "QUERY_FILAMENT_SENSOR",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Reports whether a filament sensor detects filament.",
        text("SENSOR", "the name of the sensor"),
        kind=Kind.QUIET,
        lacks=_LACKS,
    )
    def _query(self, command: Command, reply: Reply) -> None:
        sensor = self._named(command)
        found = "filament detected" if sensor.detected else "filament not detected"
        reply.say(f"// Filament Sensor {sensor.name}: {found}")

    def _named(self, command: Command) -> Sensor:
        wanted = command.string("SENSOR")
        name = found_name(self.sensors, wanted)
        if name is None:
            known = ", ".join(self.sensors)
            raise CommandError.of("command.value", axis="SENSOR", value=wanted, limit=known)
        return self.sensors[name]

    @command(
        "M412",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Switches all filament sensors on (S1) or off (S0). D is the filament that is used before"
        " the print pauses. R lets a sensor without filament act again. Without parameters it"
        " reports the setting. H has no effect, because hosts always receive the pause.",
        number("S", "1: on, 0: off"),
        number("D", "the filament that is used before the pause", "mm", 0, _LONGEST_MM),
        flag("R", "lets a sensor without filament act again"),
        ignored("H"),
        kind=Kind.QUIET,
        lacks=_LACKS,
        in_turn=True,
    )
    def _runout(self, command: Command, reply: Reply) -> None:
        sensors = self.sensors.values()
        if command.has("S"):
            self._enable(sensors, on=command.value("S") != 0)
        for sensor in sensors:
            sensor.delay_mm = command.value("D", sensor.delay_mm)
            sensor.acts = sensor.acts or command.flag("R")
        if not command.values:
            on = "ON" if any(sensor.enabled for sensor in sensors) else "OFF"
            mm = numeral(max((sensor.delay_mm for sensor in sensors), default=0.0))
            reply.say(f"echo:Filament runout {on} ; Distance {mm}mm")

    @command(
        "M591",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Switches the filament sensors of an extruder on (S1, S2) or off (S0). Without S it reports"
        " them. The machine file has their pins and lengths.",
        integer("D", "the extruder", 0, default=0),
        number("S", "1 or 2: on, 0: off"),
        refused("PCRELA", "filament_sensors"),
        kind=Kind.QUIET,
        lacks=_LACKS,
        in_turn=True,
    )
    def _monitor(self, command: Command, reply: Reply) -> None:
        at = command.integer("D")
        if not at < max(len(self._extruders), 1):
            raise CommandError.bad_value("D", at, f"0 to {len(self._extruders) - 1}")
        name = self._extruders[at] if self._extruders else None
        own = [s for s in self.sensors.values() if s.config.extruder in (None, name)]
        if command.has("S"):
            self._enable(own, on=command.value("S") > 0)
            return
        for sensor in own:
            reply.say(self._described(sensor))
        if not own:
            reply.say(f"echo:Extruder {at} has no filament sensor")

    def _described(self, sensor: Sensor) -> str:
        on = "enabled" if sensor.enabled else "disabled"
        present = "yes" if sensor.detected else "no"
        text = f"echo:Filament sensor {sensor.name} ({sensor.config.kind}) on pin"
        text += f" {sensor.config.pin}, {on}, filament present: {present}"
        if sensor.moves:
            since = max(self.pushed_mm(sensor) - sensor.mm, 0.0)
            text += f", {since:.1f} of {numeral(sensor.config.length_mm)} mm since the last pulse"
        return text

    def setting_lines(self) -> Iterator[str]:
        """SET_FILAMENT_SENSOR with the settings of each sensor."""
        for name, sensor in self.sensors.items():
            delay = numeral(sensor.delay_mm)
            on = int(sensor.enabled)
            yield f"SET_FILAMENT_SENSOR SENSOR={name} ENABLE={on} DELAY_MM={delay}"

    def _enable(self, sensors: Iterable[Sensor], *, on: bool) -> None:
        for sensor in sensors:
            if on and not sensor.enabled and sensor.moves:
                sensor.mm, sensor.detected = self.pushed_mm(sensor), True
            sensor.enabled = on
