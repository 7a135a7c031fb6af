"""Inputs of the machine: filament sensors and buttons."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from passo.config.findings import Finding, did_you_mean, table, tables
from passo.config.types import ExtruderName, Model, PartName, Pin

_Seconds = Annotated[float, Field(ge=0, le=60)]
_Length = Annotated[float, Field(ge=0, le=5000)]


class FilamentSensor(Model):
    """A sensor of the filament on a pin. `passo serve` pauses a print when the filament ends."""

    pin: Pin
    """The input. It is high while there is filament; `!` in front: it is low. `^` in front switches
    a pull-up on. The input of a motion sensor changes its level as the filament moves."""
    kind: Literal["switch", "motion"] = "switch"
    """A switch reports whether there is filament. The wheel of a motion sensor gives pulses while
    the filament moves, and also reports filament that is stuck."""
    extruder: ExtruderName | None = None
    """The extruder of the filament. The sensor acts only while a tool with this extruder is in use.
    If not given, it acts for every tool; a motion sensor then belongs to the first extruder."""
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
    """A level counts when it stays for this time. A board ignores changes below 4 ms."""


FilamentSensors = dict[PartName, FilamentSensor]
Buttons = dict[PartName, Button]


def sensor_input(name: str) -> str:
    """The name of a filament sensor's input on its board."""
    return f"filament-{name}"


def button_input(name: str) -> str:
    """The name of a button's input on its board."""
    return f"button-{name}"


def check_inputs(data: Mapping[str, Any]) -> Iterator[Finding]:
    """Checks that the extruders of filament sensors exist."""
    extruders = table(data, "extruders")
    for name, sensor in tables(data, "filament_sensors"):
        path = ("filament_sensors", name, "extruder")
        wanted = sensor.get("extruder")
        if wanted is not None and wanted not in extruders:
            limit = "one of the extruders"
            yield Finding("config.value", path, wanted, limit, did_you_mean(wanted, extruders))
        if wanted is None and sensor.get("kind") == "motion" and not extruders:
            yield Finding("config.missing-key", path, None, "a machine with an extruder")
