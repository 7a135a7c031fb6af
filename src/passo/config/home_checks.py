"""What only a machine whose parts are all sound can tell about its home and parking place."""

from __future__ import annotations

from collections.abc import Iterator

from passo.config.findings import Finding
from passo.config.machine import MachineConfig
from passo.config.types import LEAST_SCALE, MOST_SCALE
from passo.geometry.base import Unreachable


def check_home(machine: MachineConfig) -> Iterator[Finding]:
    """The nozzle can be where all is at home: arms and axes at their switches, axes without one
    where the file says."""
    try:
        machine.geometry.inverse(machine.home_point)
    except (Unreachable, ArithmeticError) as error:
        arms = [name for name in machine.geometry.arms if name in machine.homing]
        switches = arms or [name for name in "zyx" if name in machine.homing]
        if switches:
            limit = f"a place where the nozzle can be: {error}"
            value = machine.homing[switches[0]].position
            yield Finding("config.value", ("homing", switches[0], "position"), value, limit)
        else:
            limit = f"a home that the arms reach: {error}"
            x, y, z = machine.home_point
            yield Finding("config.value", ("axes", "x"), f"at home at {x:g}, {y:g}, {z:g}", limit)


def check_park(machine: MachineConfig) -> Iterator[Finding]:
    """The nozzle waits where its axes go."""
    place = machine.park.position_mm if machine.park else None
    for name, mm in zip("xy", place or (), strict=False):
        low, high = machine.axes[name].min_mm, machine.axes[name].max_mm
        if not low <= mm <= high:
            limit = f"{name.upper()} between {low:g} and {high:g}"
            yield Finding("config.value", ("park", "position_mm"), mm, limit)


def check_scales(machine: MachineConfig) -> Iterator[Finding]:
    """Each motor's scale, from whatever parts it comes, is one that a motor may have."""
    for name, stepper in machine.steppers.items():
        if not LEAST_SCALE <= stepper.steps_per_unit <= MOST_SCALE:
            key = "gear_ratio" if stepper.rotation_distance_mm is None else "rotation_distance_mm"
            limit = (
                f"{LEAST_SCALE:g} to {MOST_SCALE:,.0f} microsteps per mm or degree, and these parts"
                f" make {stepper.steps_per_unit:g}"
            )
            yield Finding("config.value", ("steppers", name, key), getattr(stepper, key), limit)
