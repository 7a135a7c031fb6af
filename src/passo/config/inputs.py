"""Inputs of the machine: filament sensors and buttons."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from passo.config.filament_width import FilamentWidth
from passo.config.findings import Finding, array, did_you_mean, table, tables
from passo.config.types import ExtruderName, Model, PartName, Pin

_Seconds = Annotated[float, Field(ge=0, le=60)]
_Ohm = Annotated[float, Field(ge=0, le=1e6)]
_PULL_UP_OHM = 4700.0
_Length = Annotated[float, Field(ge=0, le=5000)]


class FilamentSensor(Model):
    """A sensor of the filament on a pin. `passo serve` pauses a print when the filament ends."""

    pin: Pin
    """The input. It is high while there is filament; `!` in front: it is low. `^` in front switches
    a pull-up on. The input of a motion sensor changes its level as the filament moves. That of a
    width sensor is an analog input."""
    kind: Literal["switch", "motion", "width"] = "switch"
    """A switch reports whether there is filament. The wheel of a motion sensor gives pulses while
    the filament moves, and also reports filament that is stuck. A width sensor measures the
    diameter of the filament, and corrects the flow."""
    width: FilamentWidth | None = None
    """How a width sensor measures."""
    extruder: ExtruderName | None = None
    """The extruder of the filament. The sensor acts only while a tool with this extruder is in use.
    If not given, it acts for every tool; a motion or width sensor then belongs to the first
    extruder."""
    length_mm: Annotated[float, Field(gt=0, le=1000)] = 7.0
    """Of a motion sensor: when the extruder has pushed this length since the last pulse, the
    filament has ended or is stuck."""
    delay_mm: _Length = 0.0
    """The print pauses when this much more filament is used, because it reaches from the sensor to
    the nozzle. M412 D sets it, too."""
    enabled: bool = True
    """Whether the sensor acts after the start. SET_FILAMENT_SENSOR and M412 change it."""
    on_runout: Literal["pause", "none"] = "pause"
    """Whether a print pauses when the filament ends."""
    runout_gcode: str = ""
    """A template of G-code, as in a macro, that runs when the filament ends during a print; after
    the pause, if there is one."""
    insert_gcode: str = ""
    """A template of G-code that runs when filament is inserted while nothing prints, as in a pause.
    """
    unload_mm: _Length = 0.0
    """The length that the hotend pushes back when the print has paused and parked."""
    load_mm: _Length = 0.0
    """The length that the hotend pushes before the print resumes: from the sensor to the nozzle,
    and what is purged."""
    event_delay_s: _Seconds = 3.0
    """After an event has been handled, the sensor ignores changes for this time."""
    debounce_s: _Seconds = 0.1
    """The level of a switch counts when it stays for this time."""


class Button(Model):
    """A button, a door switch or another switch on a pin."""

    pin: Pin
    """The input. The button is pressed while it is high; `!` in front: while it is low. `^` in
    front switches a pull-up on."""
    action: Literal["none", "pause", "resume", "cancel", "halt"] = "none"
    """What a press does: pause, resume or cancel the print, or halt the printer as M112 does."""
    press_gcode: str = ""
    """A template of G-code, as in a macro, that runs when the button is pressed."""
    release_gcode: str = ""
    """A template of G-code that runs when the button is released."""
    debounce_s: _Seconds = 0.0
    """A level counts when it stays for this time. A board ignores changes below 4 ms, on an analog
    input those below 20 ms."""
    resistance_ohm: Annotated[list[_Ohm], Field(min_length=2, max_length=2)] | None = None
    """Of a button on an analog input: it is pressed while the resistance from the pin to ground is
    in this range. Several buttons of different ranges may share the pin."""
    pull_up_ohm: Annotated[float, Field(gt=0, le=1e6)] = _PULL_UP_OHM
    """The resistor from an analog input to its supply; equal for all buttons of one pin."""

    @property
    def shares(self) -> tuple[float, float]:
        """The range of an analog input, as fractions of its full scale."""
        low, high = self.resistance_ohm or (0.0, 0.0)
        return low / (low + self.pull_up_ohm), high / (high + self.pull_up_ohm)


FilamentSensors = dict[PartName, FilamentSensor]
Buttons = dict[PartName, Button]


def sensor_input(name: str) -> str:
    """The name of a filament sensor's input on its board."""
    return f"filament-{name}"


def width_inputs(name: str, sensor: FilamentSensor) -> dict[str, str]:
    """The analog inputs of a width sensor and their pins, as written; none for other sensors."""
    if sensor.width is None:
        return {}
    second = sensor.width.second_pin
    return {sensor_input(name): sensor.pin} | (
        {f"{sensor_input(name)}-2": second} if second else {}
    )


def button_input(name: str) -> str:
    """The name of a button's input on its board."""
    return f"button-{name}"


def analog_input(pin: str) -> str:
    """The name of the analog input of this pin on its board."""
    return f"analog-{pin}"


def check_inputs(data: Mapping[str, Any]) -> Iterator[Finding]:
    """Checks that the extruders of filament sensors exist, and the ranges of analog buttons."""
    yield from _check_analog(data)
    extruders, measuring = table(data, "extruders"), ""
    for name, sensor in tables(data, "filament_sensors"):
        yield from _check_width(name, sensor, measuring)
        measuring = measuring or (name if "width" in sensor else "")
        path = ("filament_sensors", name, "extruder")
        wanted = sensor.get("extruder")
        if wanted is not None and wanted not in extruders:
            limit = "one of the extruders"
            yield Finding("config.value", path, wanted, limit, did_you_mean(wanted, extruders))
        if wanted is None and sensor.get("kind") in ("motion", "width") and not extruders:
            yield Finding("config.missing-key", path, None, "a machine with an extruder")


def _check_width(name: str, sensor: Mapping[str, Any], other: str) -> Iterator[Finding]:
    """Checks that a width sensor, and no other one, has a table of its measurement with two
    readings and two diameters, and that it is the only one; `other` is the name of another one."""
    path, width = ("filament_sensors", name, "width"), table(sensor, "width")
    if ("width" in sensor) != (sensor.get("kind") == "width"):
        yield Finding("config.conflict", path, None, 'both kind = "width" and this table, or none')
    if "width" in sensor and other:
        owner = ("filament_sensors", other, "width")
        limit = "at most one sensor of the width; the other one is"
        yield Finding("config.conflict", path, None, limit, owner=owner)
    for key in ("readings", "diameters_mm"):
        pair = array(width, key)
        if len(pair) == 2 and pair[0] == pair[1]:
            yield Finding("config.value", (*path, key), pair, "two different values")


def _check_analog(data: Mapping[str, Any]) -> Iterator[Finding]:
    """Checks that each range rises, and that buttons of one pin have one pull-up and ranges apart
    from each other."""
    before: list[tuple[str, Mapping[str, Any], float, float]] = []
    for name, button in tables(data, "buttons"):
        ohm = [value for value in array(button, "resistance_ohm") if isinstance(value, int | float)]
        if len(ohm) != 2:
            continue
        path, (low, high) = ("buttons", name, "resistance_ohm"), ohm
        if low >= high:
            yield Finding("config.value", path, ohm, "a minimum, and a higher maximum")
        for other, others, from_ohm, to_ohm in before:
            if others.get("pin") != button.get("pin"):
                continue
            if low < to_ohm and high > from_ohm:
                limit, owner = "a range of its own: it overlaps with", ("buttons", other, path[2])
                yield Finding("config.conflict", path, ohm, limit, owner=owner)
            key, owner = ("buttons", name, "pull_up_ohm"), ("buttons", other, "pull_up_ohm")
            value, first = (b.get("pull_up_ohm", _PULL_UP_OHM) for b in (button, others))
            if value != first:
                yield Finding("config.conflict", key, value, "that of the same pin at", owner=owner)
        before.append((name, button, low, high))
