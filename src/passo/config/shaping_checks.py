"""Checks the input shapers, the limit of jerk, the advance and the backlash of a machine file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from passo.config.findings import Finding
from passo.config.jerk import least_jerk
from passo.config.shapers import max_damping

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


def check_shaping(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that the type allows the damping ratio, that the limit of jerk is not too low, and
    that the machine has no laser whose power follows the motion."""
    for name, shaping in machine.shaping.items():
        most = max_damping(shaping.type)
        if shaping.damping > most:
            limit = f"at most {most:g} for the type {shaping.type}"
            yield Finding("config.value", ("shaping", name, "damping"), shaping.damping, limit)
        if machine.laser is not None:
            limit = "no shaping on a machine with a laser, whose power follows the plan"
            yield Finding("config.conflict", ("shaping", name, "type"), shaping.type, limit)
    jerk = machine.limits.jerk_mm_s3
    if jerk is None:
        return
    key = ("limits", "jerk_mm_s3")
    if jerk < (least := least_jerk(machine.largest_accel_mm_s2)):
        limit = f"at least {least:.0f} mm/s³ with the accelerations of this machine"
        yield Finding("config.value", key, jerk, limit)
    if machine.laser is not None:
        limit = "no limit of jerk on a machine with a laser, whose power follows the plan"
        yield Finding("config.conflict", key, jerk, limit)


def check_advance(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that the knees of the advance of each extruder begin below its advance, that their
    speeds rise and that their values fall."""
    for name, extruder in machine.extruders.items():
        path = ("extruders", name, "advance_knees")
        speed, advance = 0.0, extruder.advance_s or 0.0
        if extruder.advance_knees and not advance:
            yield Finding("config.value", path, extruder.advance_knees, "an advance_s above 0")
            continue
        for knee in extruder.advance_knees:
            if knee[0] <= speed or knee[1] > advance:
                limit = f"a speed above {speed:g} mm/s, and at most {advance:g} s"
                yield Finding("config.value", path, knee, limit)
            speed, advance = knee


def check_backlash(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that each axis with a gap has its own motors, and that the gap is at most the distance
    over which it is taken up."""
    smooth_mm = machine.backlash.smooth_mm
    for name, mm in machine.gaps_mm.items():
        path = ("backlash", f"{name}_mm")
        if mm > 0 and name not in machine.geometry.actuators:
            limit = f"0, as no motor moves {name.upper()} alone on this machine"
            yield Finding("config.conflict", path, mm, limit)
        elif mm > smooth_mm:
            yield Finding("config.value", path, mm, f"at most backlash.smooth_mm, {smooth_mm:g}")
