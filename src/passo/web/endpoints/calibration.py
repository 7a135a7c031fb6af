"""Calibrations: measure values on the machine, and set them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Literal

from msgspec import Meta, Struct

from passo.catalogue import codes_of
from passo.config.heater_numbers import number_of
from passo.config.thermistor import Ntc
from passo.errors import InputError, WebError
from passo.gcode.command import Command
from passo.heat.calibration import (
    FAR,
    MAX_BETA_K,
    MAX_C_PER_K,
    MIN_BETA_K,
    Calibration,
    Point,
    by_least_squares,
    by_steinhart_hart,
)
from passo.web.call import Call
from passo.web.endpoints.console import Answer
from passo.web.operation import operation
from passo.web.roles import Role

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

Celsius = Annotated[float, Meta(gt=0, le=400)]

Procedure = Literal["gantry", "screws", "delta"]
_PROCEDURES: dict[str, str] = {"gantry": "G34", "screws": "G35", "delta": "G33"}
_RULES = {"pid": {"C": 8, "R": 0}, "model": {"R": 5}}
_HOME = Command.call("G28")
_ERRORS = ("web.not-found", "command.value", "command.halted", "command.failed")


class HeaterTune(Struct, forbid_unknown_fields=True):
    """A heater to tune at a temperature in °C. A relay oscillation gives PID gains. A rise at full
    power gives the thermal model; for it, the heater must be cold."""

    heater: str
    celsius: Celsius
    method: Literal["pid", "model"] = "pid"


class Reading(Struct, forbid_unknown_fields=True):
    """A temperature that the printer shows, and the true temperature by a thermometer, in °C."""

    shown_c: Celsius
    true_c: Celsius


class Readings(Struct, forbid_unknown_fields=True):
    """Readings of a heater's thermistor."""

    heater: str
    readings: Annotated[list[Reading], Meta(min_length=1, max_length=50)]


class ThermistorFit(Struct):
    """A thermistor that a method has found. `residuals_c` are its errors at the readings, in °C;
    `rms_c` is their root mean square."""

    method: Literal["now", "beta", "steinhart-hart"]
    r25_ohm: float
    beta_k: float
    c_per_k: float
    residuals_c: list[float]
    rms_c: float


class Thermistor(Struct, forbid_unknown_fields=True):
    """The coefficients of a heater's thermistor: its resistance at 25 °C, β, and C of the equation
    1/T = A + B·ln R + C·(ln R)³ with B = 1/β."""

    heater: str
    r25_ohm: Annotated[float, Meta(gt=0, le=1e9)]
    beta_k: Annotated[float, Meta(ge=MIN_BETA_K, le=MAX_BETA_K)]
    c_per_k: Annotated[float, Meta(ge=0, le=MAX_C_PER_K)] = 0.0


class Levelling(Struct, forbid_unknown_fields=True):
    """A levelling procedure that uses the probe."""

    procedure: Procedure


class Resonance(Struct, forbid_unknown_fields=True):
    """An axis to measure with the accelerometer."""

    axis: Literal["x", "y", "z"]


class StallAxis(Struct, forbid_unknown_fields=True):
    """An axis that homes by the stall of its motor, and how often it homes to measure how
    exactly."""

    axis: str
    repeats: Annotated[float, Meta(ge=2, le=20, multiple_of=1)] = 5


class BedMap(Struct):
    """The correction that is added to Z, in mm: `heights_mm[j][i]` at `xs_mm[i]`, `ys_mm[j]`; empty
    before the bed is measured. `probe`: the machine has a probe. `method` comes from the machine
    file; `procedures` are those that the machine allows. `measured` is the kind of correction: a
    `mesh` has its own points, a `fit` is sampled over the bed."""

    probe: bool
    method: str
    procedures: list[Procedure]
    measured: Literal["none", "fit", "mesh"]
    on: bool
    xs_mm: list[float]
    ys_mm: list[float]
    heights_mm: list[list[float]]


@operation("calibration.tune_heater", "POST", "/calibration/heater", Role.OPERATOR, errors=_ERRORS)
async def tune_heater(call: Call, body: HeaterTune) -> Answer:
    """Tunes a heater and applies the result (M303 with U1); `settings.store` stores it. This takes
    minutes; `console.end_wait` ends it. The heater is switched off before the answer."""
    number = _heater_number(call, body.heater)
    tune = Command.call("M303", H=number, S=body.celsius, **_RULES[body.method], U=1)
    return Answer(list(await call.commands(tune)))


@operation(
    "calibration.fit_thermistor",
    "POST",
    "/calibration/thermistor/fit",
    Role.VIEWER,
    errors=("web.not-found", "input.point-far"),
)
async def fit_thermistor(call: Call, body: Readings) -> list[ThermistorFit]:
    """Fits the coefficients of a heater's thermistor to readings, by each method for which there
    are enough readings. The first entry is the current thermistor. Nothing is set."""
    ntc = await _thermistor(call, body.heater)
    points = [Point(reading.shown_c, reading.true_c) for reading in body.readings]
    for point in points:
        if abs(point.true_c - point.shown_c) > FAR * point.shown_c:
            limit = f"{(1 - FAR) * point.shown_c:.0f} to {(1 + FAR) * point.shown_c:.0f}"
            raise InputError.of(
                "input.point-far", value=point.true_c, key=point.shown_c, limit=limit
            )
    off = tuple(point.shown_c - point.true_c for point in points)
    now = Calibration(ntc.beta_k, off, ntc.r25_ohm, ntc.c_per_k)
    found = [_fit("now", now), _fit("beta", by_least_squares(ntc, points))]
    full = by_steinhart_hart(ntc, points)
    if full is not None:
        found.append(_fit("steinhart-hart", full))
    return found


@operation(
    "calibration.set_thermistor",
    "PUT",
    "/calibration/thermistor",
    Role.OPERATOR,
    errors=("heat.no-thermistor", "heat.reads-nothing", *_ERRORS),
)
async def set_thermistor(call: Call, body: Thermistor) -> None:
    """Sets the thermistor of a heater at once (M305), until `settings.store` stores it."""
    number = _heater_number(call, body.heater)
    words = {"A": body.r25_ohm, "B": body.beta_k, "C": body.c_per_k}
    await call.command("M305", H=number, **words)


@operation(
    "calibration.measure_bed",
    "POST",
    "/calibration/bed",
    Role.OPERATOR,
    errors=("levelling.no-area", "levelling.no-points", "input.not-homed", *_ERRORS),
)
async def measure_bed(call: Call) -> Answer:
    """Homes all axes, measures the bed by the method of the machine file, and switches the
    correction on (G28, G29)."""
    return Answer(list(await call.commands(_HOME, Command.call("G29"))))


@operation(
    "calibration.repeat_probe",
    "POST",
    "/calibration/probe",
    Role.OPERATOR,
    errors=("input.not-homed", *_ERRORS),
)
async def repeat_probe(call: Call) -> Answer:
    """Homes all axes, and probes the bed ten times in one place (G28, M48)."""
    return Answer(list(await call.commands(_HOME, Command.call("M48", P=10))))


@operation(
    "calibration.level",
    "POST",
    "/calibration/level",
    Role.OPERATOR,
    errors=("input.not-homed", *_ERRORS),
)
async def level(call: Call, body: Levelling) -> Answer:
    """Homes all axes, and then levels the gantry by its motors (G34), reports how far to turn the
    bed screws (G35), or calibrates the geometry of a delta (G33). `calibration.bed` lists the
    procedures that the machine allows."""
    if body.procedure not in _procedures(call.bridge.machine):
        raise WebError.of("web.not-found", value=f"procedure {body.procedure} of this machine")
    return Answer(list(await call.commands(_HOME, Command.call(_PROCEDURES[body.procedure]))))


@operation(
    "calibration.measure_shaper",
    "POST",
    "/calibration/shaper",
    Role.OPERATOR,
    errors=(*codes_of("resonance"), *_ERRORS),
)
async def measure_shaper(call: Call, body: Resonance) -> Answer:
    """Homes all axes, vibrates an axis for about two minutes, chooses its input shaper, and uses it
    until `settings.store` stores it (G28, SHAPER_CALIBRATE). `machine.get` reports whether the
    machine has an accelerometer."""
    if call.bridge.machine.accelerometer is None:
        raise WebError.of("web.not-found", value="accelerometer of this machine")
    measure = Command.call("SHAPER_CALIBRATE", AXIS=body.axis.upper())
    return Answer(list(await call.commands(_HOME, measure)))


@operation(
    "calibration.find_stall",
    "POST",
    "/calibration/stall",
    Role.OPERATOR,
    errors=("machine.stall-unstable", *_ERRORS),
)
async def find_stall(call: Call, body: StallAxis) -> Answer:
    """Finds the threshold with which an axis homes by the stall of its motor, homes with it, and
    reports how exactly (STALL_CALIBRATE); `settings.store` stores it. Before, the axis must be in
    the middle of its travel. `machine.get` lists the axes that home by a stall."""
    home = call.bridge.machine.homing.get(body.axis)
    if home is None or home.stall is None:
        raise WebError.of("web.not-found", value=f"axis {body.axis} that homes by a stall")
    find = Command.call("STALL_CALIBRATE", AXIS=body.axis.upper(), REPEATS=body.repeats)
    return Answer(list(await call.commands(find)))


@operation("calibration.bed", "GET", "/calibration/bed", Role.VIEWER)
async def bed(call: Call) -> BedMap:
    """The active map of the bed, or the last one that was measured."""
    machine = call.bridge.machine
    state = await call.bridge.bed()
    correction = state.correction
    found = BedMap(
        probe=machine.probe is not None,
        method=machine.levelling.method,
        procedures=list(_procedures(machine)),
        measured="none",
        on=state.on,
        xs_mm=[],
        ys_mm=[],
        heights_mm=[],
    )
    if correction is None:
        return found
    found.measured = "fit" if correction.mesh is None else "mesh"
    table = correction.table(machine.bed_area_mm)
    found.xs_mm, found.ys_mm = list(table.xs), list(table.ys)
    found.heights_mm = [list(row) for row in table.heights]
    return found


def _procedures(machine: MachineConfig) -> Iterator[Procedure]:
    if machine.probe is None:
        return
    if machine.levelling.motors is not None:
        yield "gantry"
    if machine.levelling.screws is not None:
        yield "screws"
    if machine.geometry.kind == "delta":
        yield "delta"


def _heater_number(call: Call, name: str) -> int:
    """The H number of a heater in commands."""
    machine = call.bridge.machine
    number = number_of(machine, name) if name in machine.heaters else None
    if number is None:
        raise WebError.of("web.not-found", value=f"heater {name}")
    return number


async def _thermistor(call: Call, name: str) -> Ntc:
    """The active thermistor of a heater, which M305 may have changed."""
    command = f"M305 H{_heater_number(call, name)}"
    values = {s.word: float(s.value) for s in await call.bridge.settings() if s.command == command}
    if not values:
        raise WebError.of("web.not-found", value=f"thermistor of heater {name}")
    return Ntc(values["A"], values["B"], values["C"])


def _fit(method: Literal["now", "beta", "steinhart-hart"], found: Calibration) -> ThermistorFit:
    return ThermistorFit(
        method,
        found.r25_ohm,
        found.beta_k,
        found.c_per_k,
        list(found.residuals_c),
        found.rms_c,
    )
