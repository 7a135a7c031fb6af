"""Checks of predefined moves, which need a machine file without other errors."""

from __future__ import annotations

from collections.abc import Iterator

from passo.config.findings import Finding, did_you_mean
from passo.config.machine import MachineConfig
from passo.config.predefined_moves import hooked
from passo.geometry.base import Unreachable


def check_moves(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that the moves are of axes, within their limits, and that those after homing lead to
    places that the nozzle reaches."""
    found = [*_check_axes(machine)]
    yield from found
    if not found:
        yield from _check_reach(machine)


def _check_axes(machine: MachineConfig) -> Iterator[Finding]:
    movable = {name: axis for name, axis in machine.axes.items() if not axis.extruder}
    for name, move in machine.moves.items():
        unhomed = move.hook == "before_homing"
        if unhomed and not move.relative:
            limit = "true for a move before homing, when no position is known yet"
            yield Finding("config.conflict", ("moves", name, "relative"), move.relative, limit)
        for key, mm in move.position_mm.items():
            path = ("moves", name, "position_mm", key)
            axis = movable.get(key)
            if axis is None:
                limit = f"a position of an axis: {', '.join(movable)}"
                yield Finding("config.value", path, mm, limit, did_you_mean(key, movable))
                continue
            if unhomed and key in machine.axes_of_arms:
                limit = "no such key: before homing, arms do not move the nozzle on known paths"
                yield Finding("config.conflict", path, mm, limit)
            low, high = axis.min_mm, axis.max_mm
            if move.relative:
                low, high = low - high, high - low
            if not low <= mm <= high:
                limit = f"{low:g} to {high:g} mm"
                yield Finding("config.value", path, mm, limit)


def _check_reach(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that the nozzle reaches the places of the moves after homing. Each place may depend on
    the one before it."""
    try:
        at = dict(machine.home_mm)
    except Unreachable:
        return  # an error of its own
    for name, move in hooked(machine.moves, "after_homing"):
        for key, mm in move.position_mm.items():
            at[key] = at[key] + mm if move.relative else mm
            axis = machine.axes[key]
            if move.relative and not axis.min_mm <= at[key] <= axis.max_mm:
                limit = (
                    f"a distance that ends at {axis.min_mm:g} to {axis.max_mm:g} mm, not at"
                    f" {at[key]:g} mm"
                )
                yield Finding("config.value", ("moves", name, "position_mm", key), mm, limit)
        try:
            machine.geometry.inverse((at["x"], at["y"], at["z"]))
        except (Unreachable, ArithmeticError) as error:
            limit = f"a place that the nozzle reaches: {error}"
            value = " ".join(f"{a.upper()}{mm:g}" for a, mm in move.position_mm.items())
            yield Finding("config.value", ("moves", name, "position_mm"), value, limit)
            return
