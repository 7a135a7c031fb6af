"""The mechanics and heat around a simulated board, as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from passo import _core
from passo.probes.base import Mechanism


@dataclass(frozen=True, slots=True)
class Actuator:
    """The mechanism that a stepper moves; its position (mm or degrees) starts at `start`."""

    stepper: str
    steps_per_unit: float
    start: float = 0.0


@dataclass(frozen=True, slots=True)
class Switch:
    """The endstop `endstop` is triggered while the weighted sum of some steppers' actuator
    positions is at or beyond `position`: above it if `at_maximum`, else below. A triggered endstop
    reads 1 (0 if the pin is inverted)."""

    endstop: str
    weights: tuple[tuple[str, float], ...]
    position: float
    at_maximum: bool = False


@dataclass(frozen=True, slots=True)
class TravelStop:
    """A mechanical stop: the weighted sum of some steppers' actuator positions does not go beyond
    `position`, whose side is as that of a `Switch`."""

    weights: tuple[tuple[str, float], ...]
    position: float
    at_maximum: bool = False


@dataclass(frozen=True, slots=True)
class StallPin:
    """The driver of `stepper` shows stalls at `pin`, its output DIAG or DIAG0 (0) or DIAG1 (1)."""

    stepper: str
    pin: str
    output: int


@dataclass(frozen=True, slots=True)
class InputSwitch:
    """What is wired to the input `name`. Its level is `active` while the sum of some steppers'
    actuator positions, each with its weight, is at or above `position`, or opposite below. With
    `edge_mm`, the level changes each time the sum has moved by this length."""

    name: str
    weights: tuple[tuple[str, float], ...] = ()
    position: float = 1e9
    active: bool = True
    edge_mm: float = 0.0


@dataclass(frozen=True, slots=True)
class FilamentInSensor:
    """The filament in the width sensor `name`: each of the analog `inputs` reads the share
    `at_0_mm` of full scale without filament, and `at_1_mm` at a diameter of 1 mm; it is linear."""

    name: str
    inputs: tuple[str, ...]
    at_0_mm: float
    at_1_mm: float

    def share(self, diameter_mm: float) -> float:
        """The reading at a diameter."""
        share = self.at_0_mm + (self.at_1_mm - self.at_0_mm) * diameter_mm
        return min(max(share, 0.0), 1.0)


@dataclass(frozen=True, slots=True)
class Body:
    """The mass that a heater heats: it tends to `ambient_c` + `rise_c` · power with
    `time_constant_s`; its sensor follows with `sensor_time_constant_s`. With the output `fan` at
    full speed it loses 1 + `fan_loss` times as much heat."""

    heater: str
    rise_c: float
    time_constant_s: float
    sensor_time_constant_s: float = 2.0
    ambient_c: float = 25.0
    fan: str | None = None
    fan_loss: float = 0.0


@dataclass(frozen=True, slots=True)
class Air:
    """The sensor `sensor` measures a place at `ambient_c`, which nothing heats."""

    sensor: str
    ambient_c: float


@dataclass(frozen=True, slots=True)
class Rotor:
    """The rotor of the fan on the output `fan`, whose tachometer is on the counter `counter`. Its
    speed tends to `full_rpm` · power with `time_constant_s`."""

    counter: str
    fan: str
    full_rpm: float
    pulses: int
    time_constant_s: float = 0.5


Area = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Bed:
    """A bed that is not flat: `area_mm` is its rectangle x0, y0, x1, y1. `tilt_mm` is the rise over
    the width and the depth, `dome_mm` the height of the centre above the corners."""

    area_mm: Area
    tilt_mm: tuple[float, float] = (0.0, 0.0)
    dome_mm: float = 0.0
    wave_mm: float = 0.0
    wave_length_mm: tuple[float, float] = (120.0, 160.0)
    height_mm: float = 0.0

    @property
    def shape(self) -> _core.Bed:
        """The shape of the bed for the core."""
        x0, y0, x1, y1 = self.area_mm
        return _core.Bed(
            center=((x0 + x1) / 2, (y0 + y1) / 2),
            size=(x1 - x0, y1 - y0),
            tilt=self.tilt_mm,
            dome=self.dome_mm,
            wave=self.wave_mm,
            wave_length=self.wave_length_mm,
            lift=self.height_mm,
        )


@dataclass(frozen=True, slots=True)
class Lift:
    """One of several motors that carry the gantry. With the nozzle at X, Y, its position
    contributes to the height with the `weight` c · (1, x, y, x y)."""

    stepper: str
    weight: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class BedProbe:
    """The endstop `endstop` is a probe on the head. It triggers when the nozzle is `trigger_mm`
    above the bed at the place of the probe, which is `offset_mm` from the nozzle, and opens
    `hysteresis_mm` higher. `motors` names one stepper for each actuator of `geometry`, which has
    the form that the core takes. In a dead area the probe never triggers, in a touchy area it is
    always triggered. An eddy current probe has a coil of `coil_c` °C, and the `curve` of heights in
    mm and frequencies in Hz. `mechanism` deploys the probe, controlled by the output `control`,
    unless the probe is jammed."""

    endstop: str
    motors: tuple[str, ...]
    geometry: Mapping[str, Any]
    bed: Bed
    offset_mm: tuple[float, float]
    trigger_mm: float
    hysteresis_mm: float = 0.0
    noise_mm: float = 0.0
    seed: int = 1
    forced: bool | None = None
    dead_areas: tuple[Area, ...] = ()
    touchy_areas: tuple[Area, ...] = ()
    mechanism: Mechanism = field(default_factory=Mechanism)
    control: str | None = None
    jammed: bool = False
    coil_c: float = 25.0
    curve: tuple[tuple[float, float], ...] = ()
    lifts: tuple[Lift, ...] = ()


@dataclass(frozen=True, slots=True)
class PlantDescription:
    """Mechanics and heat of one simulated printer."""

    actuators: tuple[Actuator, ...] = ()
    switches: tuple[Switch, ...] = ()
    inputs: tuple[InputSwitch, ...] = ()
    widths: tuple[FilamentInSensor, ...] = ()
    stops: tuple[TravelStop, ...] = ()
    stall_pins: tuple[StallPin, ...] = ()
    bodies: tuple[Body, ...] = ()
    airs: tuple[Air, ...] = ()
    rotors: tuple[Rotor, ...] = ()
    probe: BedProbe | None = None
