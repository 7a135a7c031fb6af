"""The smoothing of pressure advance: the default for an extruder, and what a smoothing costs."""

from __future__ import annotations

from math import ceil, inf, sqrt
from typing import NamedTuple

from passo.config.motion import MIN_SMOOTH_S, Extruder

SHORT_SMOOTH_S, LONG_SMOOTH_S = 0.02, 0.04  # the default, and that of a slow extruder at most
TYPICAL_ADVANCE_S = 0.05  # of a direct drive, where the machine file has no advance
LINE = 0.06  # mm of filament for a mm of a line that is 0.5 mm wide and 0.3 mm high


class PathLimits(NamedTuple):
    """The acceleration of prints, and their speed at a right angle."""

    accel_mm_s2: float
    square_corner_mm_s: float


def smooth_s(path: PathLimits, extruder: Extruder) -> float:
    """The time over which the advance of this extruder is smoothed, s."""
    if extruder.advance_smooth_s is not None:
        return max(extruder.advance_smooth_s, MIN_SMOOTH_S)
    return default_smooth_s(path, extruder)


def default_smooth_s(path: PathLimits, extruder: Extruder) -> float:
    """SHORT_SMOOTH_S if with it the extruder's acceleration allows wide lines the acceleration of
    prints, and their corners the speed of a right angle. Otherwise as much more as that takes, in
    whole ms, and at most LONG_SMOOTH_S: beyond it lines become less even."""
    advance = max(extruder.advance_s or 0.0, TYPICAL_ADVANCE_S)
    room = extruder.accel_mm_s2 / (LINE * path.accel_mm_s2) - 1
    ramps = 2 * advance / room if room > 0 else inf
    change = advance * LINE * path.square_corner_mm_s
    needed = max(SHORT_SMOOTH_S, ramps, 2 * sqrt(change / extruder.accel_mm_s2))
    return min(ceil(needed * 1000 - 1e-6) / 1000, LONG_SMOOTH_S) if needed < inf else LONG_SMOOTH_S


def half_smooth_s(path: PathLimits, extruder: Extruder) -> float:
    """Half of the smoothing time, as the core has it; 0 if the file gives no advance, so that
    motors are not delayed for it."""
    given = extruder.advance_s is not None or extruder.advance_smooth_s is not None
    return smooth_s(path, extruder) / 2 if given else 0.0


def line_accel_mm_s2(extruder: Extruder, advance_s: float, smooth: float) -> float:
    """The acceleration of a wide line that the extruder allows with this advance, mm/s²."""
    return extruder.accel_mm_s2 / (LINE * (1 + 2 * advance_s / smooth))


def cost(path: PathLimits, extruder: Extruder, advance_s: float, smooth: float) -> str:
    """What a smoothing time costs wide lines, as a clause; empty if it costs nothing."""
    allowed = line_accel_mm_s2(extruder, advance_s, smooth)
    if advance_s == 0 or allowed >= path.accel_mm_s2:
        return ""
    return (
        f"the extruder's accel_mm_s2 of {extruder.accel_mm_s2:g} then allows a line of 0.5 x 0.3 mm"
        f" {allowed:.0f} mm/s² of the {path.accel_mm_s2:g} of prints"
    )


def smoothing_note(path: PathLimits, name: str, extruder: Extruder) -> str | None:
    """The note of `passo check` about the smoothing of an extruder; None without an advance."""
    if not extruder.advance_s:
        return None
    smooth, key = smooth_s(path, extruder), f"extruders.{name}.advance_smooth_s"
    costs = cost(path, extruder, extruder.advance_s, smooth)
    if extruder.advance_smooth_s is not None:
        if extruder.advance_smooth_s < MIN_SMOOTH_S:
            costs = f"Passo smooths over at least {MIN_SMOOTH_S:g} s" + (f"; {costs}" * bool(costs))
        return f"{key} is {extruder.advance_smooth_s:g}: {costs}" if costs else None
    if smooth > SHORT_SMOOTH_S:
        why = (
            f"the extruder's accel_mm_s2 of {extruder.accel_mm_s2:g} does not allow"
            f" {SHORT_SMOOTH_S:g} s"
        )
    else:
        why = (
            "the extruder's limits allow it, and lines become more even than with Klipper's 0.04 s"
        )
    return f"{key} is not given: the advance is smoothed over {smooth:g} s, because {why}" + (
        f"; {costs}" if costs else ""
    )
