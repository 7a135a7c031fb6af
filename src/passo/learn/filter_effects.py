"""What the motion filters do to planned moves, in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from passo.config.jerk import right_angle_mm, spread_mm
from passo.config.shapers import impulses

if TYPE_CHECKING:
    from passo import _core
    from passo.printer.commands.motion_filters import MotionFilters

_E = 3  # index of the extruder in a move's positions


def filter_effects(filters: MotionFilters, moves: Sequence[_core.Move]) -> tuple[str, ...]:
    """A line for each shaper of an axis that the moves move, for the limit of jerk, for filament
    that is shaped, for the advance, and for the delay of all motors. Empty without filters."""
    delay_s = filters.delay_s
    moves = [move for move in moves if move.kind != "dwell"]
    if delay_s == 0 or not moves:
        return ()
    lines: list[str] = []
    for slot, (axis, shaper) in enumerate(filters.shapers.items()):
        hardest = max(_part(move, slot) * _hardest(move) for move in moves)
        if shaper.frequency_hz == 0 or hardest == 0:
            continue
        pulses = impulses(shaper.kind, shaper.frequency_hz, shaper.damping)
        off_mm = spread_mm(0.0, pulses, hardest)
        lines.append(
            f"{axis}: {shaper.kind} at {shaper.frequency_hz:g} Hz spreads each change of speed over"
            f" {pulses[-1][1] * 1e3:.1f} ms; while {axis} speeds up by {hardest:.0f} mm/s² it is"
            f" {off_mm * 1e3:.0f} µm off the plan"
        )
    box_s = filters.box_s
    if box_s > 0:
        hardest = max(_hardest(move) for move in moves)
        speed = max(max(move.start_speed, move.end_speed) for move in moves)
        cut_mm = right_angle_mm(box_s, [], hardest, speed)
        lines.append(
            f"jerk: all positions are means over {box_s * 1e3:.1f} ms, so that the acceleration of"
            f" no axis changes by more than {filters.jerk_mm_s3:g} mm/s³ between corners; while the"
            f" move speeds up by {hardest:.0f} mm/s² the head is"
            f" {spread_mm(box_s, [], hardest) * 1e3:.0f} µm off the plan, and a right"
            f" angle at its end is cut by up to {cut_mm * 1e3:.0f} µm"
        )
    extrudes = [move for move in moves if _part(move, _E) > 0]
    if any(filters.shapes_filament(move.extruder) for move in extrudes):
        lines.append("E: the filament follows the shapers of X and Y, as the head does")
    advanced = [move for move in moves if move.advance_s > 0]
    if advanced:
        move = max(advanced, key=lambda m: m.advance_s * _part(m, _E) * m.cruise_speed)
        speed, accel = _part(move, _E) * move.cruise_speed, _part(move, _E) * _hardest(move)
        knees = filters.knees(move.extruder, move.advance_s)
        above = "".join(f", {less:g} s above {knee:g} mm/s" for knee, less in knees if knee < speed)
        lines.append(
            f"E: an advance of {move.advance_s:g} s{above} pushes"
            f" {filters.advanced_mm(move.extruder, move.advance_s, speed):.4f} mm of filament"
            f" ahead at {speed:.2f} mm/s, smoothed over"
            f" {filters.smooth_s[move.extruder] * 1e3:g} ms; while the move speeds up the extruder"
            f" does up to {speed + move.advance_s * accel:.2f} mm/s"
        )
    lines.append(f"all motors follow the plan {delay_s * 1e3:.2f} ms later")
    return tuple(lines)


def _part(move: _core.Move, slot: int) -> float:
    return abs(move.end_mm[slot] - move.start_mm[slot]) / move.length


def _hardest(move: _core.Move) -> float:
    """The greater acceleration of the phases that the move has."""
    speeds_up = move.accelerate_ticks > 0
    slows = move.decelerate_ticks > 0
    return max(abs(move.acceleration) * speeds_up, move.deceleration * slows)
