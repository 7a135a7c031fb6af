"""Checks of home and parking positions. They need a machine file without other errors."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from itertools import product
from math import isinf

from passo.config.findings import Finding
from passo.config.machine import MachineConfig
from passo.config.types import MAX_SCALE, MIN_SCALE
from passo.geometry.base import Unreachable
from passo.geometry.core_belts import CoreBelts
from passo.geometry.skewable import SkewableModel


def check_home(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that the nozzle can reach the home position: all arms and axes at their endstops, and
    axes without one at their position in the file."""
    try:
        machine.geometry.inverse(machine.home_point)
    except (Unreachable, ArithmeticError) as error:
        arms = [name for name in machine.geometry.arms if name in machine.homing]
        switches = arms or [name for name in "zyx" if name in machine.homing]
        if switches:
            limit = f"a position that the nozzle can reach: {error}"
            value = machine.homing[switches[0]].position
            yield Finding("config.value", ("homing", switches[0], "position"), value, limit)
        else:
            limit = f"a home that the arms reach: {error}"
            x, y, z = machine.home_point
            yield Finding("config.value", ("axes", "x"), f"at home at {x:g}, {y:g}, {z:g}", limit)


def check_home_sides(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that each home position is on the endstop's half of the axis or carriage; otherwise
    most moves would pass the endstop. It may be beyond the limit on its side, or in the middle, as
    for a rotary axis. Two arms may have to meet at home, far from their limits, so for a rotary arm
    only angles near the opposite limit are errors. An angle far beyond the opposite limit is
    correct if a full turn is added."""
    geometry = machine.geometry
    for name, homing in machine.homing.items():
        arm, turns = name in geometry.arms, name in geometry.rotary
        low, high = _range_of_arm(machine, name) if arm else _range_of_axis(machine, name)
        own, other, sign = (low, high, 1) if homing.direction == "min" else (high, low, -1)
        farthest = own + (other - own) * (0.75 if turns else 0.5)
        beyond = sign * (homing.position - farthest)
        around = turns and not geometry.lifts_together
        if not beyond > 0 or (around and beyond > 0.5 * (high - low)):
            continue
        part = f"axes.{name} goes from min_mm {low:g} to max_mm {high:g}"
        if arm:
            kind, unit = ("arm", "degrees") if turns else ("carriage", "mm")
            part = f"{kind} {name.upper()} goes from {low:g} to {high:g} {unit}"
        limit = (
            f"at {'most' if sign > 0 else 'least'} {farthest:g}, as {part} and"
            f' homing.{name}.direction is "{homing.direction}": from a home on the far side moves'
            " lead through the endstop"
        )
        yield Finding("config.home-side", ("homing", name, "position"), homing.position, limit)


def _range_of_axis(machine: MachineConfig, name: str) -> tuple[float, float]:
    return machine.axes[name].min_mm, machine.axes[name].max_mm


def _range_of_arm(machine: MachineConfig, name: str) -> tuple[float, float]:
    """The limits of an actuator's motors. If a limit is missing and the arms lift together, it is
    the range that the reachable ends and middles of the axes need; otherwise it is infinite.
    """
    geometry = machine.geometry
    index = geometry.actuators.index(name)
    low, high = machine.actuator_limits[index]
    if not geometry.lifts_together:
        return low, high
    axes = [machine.axes[axis] for axis in "xyz"]
    needed: list[float] = []
    for x, y, z in product(*((a.min_mm, (a.min_mm + a.max_mm) / 2, a.max_mm) for a in axes)):
        with suppress(Unreachable, ArithmeticError):
            needed.append(geometry.inverse((x, y, z))[index])
    return (
        min(needed, default=low) if isinf(low) else low,
        max(needed, default=high) if isinf(high) else high,
    )


def check_offsets(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that endstop offsets belong to motors with their own endstop."""
    for name, homing in machine.homing.items():
        for motor, mm in homing.offsets_mm.items():
            if motor not in homing.stepper_pins:
                limit = "the name of a motor in stepper_pins"
                yield Finding("config.value", ("homing", name, "offsets_mm", motor), mm, limit)


def check_own_switches(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that motors with endstops of their own are all that move their axis: no endstop would
    stop the belt of another axis that moves along."""
    axes = "xyz"
    for name, homing in machine.homing.items():
        if name not in axes or not homing.stepper_pins:
            continue
        k, home, geometry = axes.index(name), machine.home_point, machine.geometry.square
        x, y, z = (mm - 1e-3 if i == k else mm for i, mm in enumerate(home))
        moves = zip(geometry.inverse(home), geometry.inverse((x, y, z)), strict=True)
        moved = [i for i, (before, after) in enumerate(moves) if abs(after - before) > 1e-5]
        for motor in machine.steppers:
            driven = machine.driven_by(motor)
            if driven is None or driven.drive != "actuator" or driven.index not in moved:
                continue
            if driven.index not in [_index(machine, own) for own in homing.stepper_pins]:
                path, pins = ("homing", name, "stepper_pins"), [*homing.stepper_pins]
                limit = f"pin, one endstop for the axis: motor {motor} of a belt moves with it"
                yield Finding("config.value", path, ", ".join(pins), limit)


def _index(machine: MachineConfig, motor: str) -> int | None:
    driven = machine.driven_by(motor)
    return None if driven is None else driven.index


def check_skew(machine: MachineConfig) -> Iterator[Finding]:
    """Checks machines with skew, which can move motors beyond the limits of their axes. Such motors
    must have limits of their own; crossed belts must have `reach_x_mm` and `reach_y_mm`."""
    geometry = machine.geometry
    if isinstance(geometry, CoreBelts):
        yield from _check_belts(machine, geometry)
    elif isinstance(geometry, SkewableModel):
        yield from _check_motors(machine, geometry)


def _check_motors(machine: MachineConfig, geometry: SkewableModel) -> Iterator[Finding]:
    sheared = [geometry.actuators.index(axis) for axis in geometry.sheared_axes]
    for name, stepper in machine.steppers.items():
        driven = machine.driven_by(name)
        if driven is None or driven.drive != "actuator" or driven.index not in sheared:
            continue
        for key in ("min_mm", "max_mm"):
            if getattr(stepper, key) is None:
                limit = "what this motor reaches, as skew moves it beyond its axis"
                yield Finding("config.missing-key", ("steppers", name, key), None, limit)


def _check_belts(machine: MachineConfig, geometry: CoreBelts) -> Iterator[Finding]:
    """With crossed belts no motor has the position of a carriage, so the limits of the axes must
    keep the carriages within their reach. Skew is linear, so the extremes are at the corners."""
    ends = [(axis.min_mm, axis.max_mm) for axis in (machine.axes[name] for name in "xyz")]
    corners = [geometry.carriages((x, y, z)) for x, y, z in product(*ends)]
    for axis in geometry.sheared_axes:
        index, path = "xyz".index(axis), ("geometry", f"reach_{axis}_mm")
        low, high = (end(corner[index] for corner in corners) for end in (min, max))
        limit = f"at least {low:.3f} to {high:.3f} mm, where skew takes the carriage"
        reach = geometry.reach_x_mm if axis == "x" else geometry.reach_y_mm
        if reach is None:
            yield Finding("config.missing-key", path, None, limit)
        elif not (reach[0] <= low and high <= reach[1]):
            yield Finding("config.value", path, reach, limit)


def check_park(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that the parking position is within the axes."""
    place = machine.park.position_mm if machine.park else None
    for name, mm in zip("xy", place or (), strict=False):
        low, high = machine.axes[name].min_mm, machine.axes[name].max_mm
        if not low <= mm <= high:
            limit = f"{name.upper()} between {low:g} and {high:g}"
            yield Finding("config.value", ("park", "position_mm"), mm, limit)


def check_scales(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that the steps per unit of each motor are valid."""
    for name, stepper in machine.steppers.items():
        if not MIN_SCALE <= stepper.steps_per_unit <= MAX_SCALE:
            key = "gear_ratio" if stepper.rotation_distance_mm is None else "rotation_distance_mm"
            limit = (
                f"{MIN_SCALE:g} to {MAX_SCALE:,.0f} microsteps per mm or degree, and these parts"
                f" make {stepper.steps_per_unit:g}"
            )
            yield Finding("config.value", ("steppers", name, key), getattr(stepper, key), limit)
