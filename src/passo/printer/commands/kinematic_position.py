"""SET_KINEMATIC_POSITION: its parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from passo.gcode.command import Command
from passo.motion.set_position import place_of_axes

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig


class Positions(NamedTuple):
    """The new positions, mm by axis number, and the names of the axes that do not count as homed
    then."""

    places: dict[int, float]
    lost: set[str]


def positions(command: Command, machine: MachineConfig, job: _core.Job) -> Positions:
    """What the command sets. Raises CommandError."""
    pairs, at = command.pairs(), job.machine_position
    given = [axis for axis in "XYZ" if axis in pairs]
    if not given and "CLEAR_HOMED" not in pairs:
        given = list("XYZ")
    placed = {axis: round(command.value(axis, at["XYZ".index(axis)]), 9) for axis in given}
    places = place_of_axes(Command.call("G92", **placed), machine, job)
    homed = pairs.get("SET_HOMED", "xyz").lower()
    lost = {a for a in pairs.get("CLEAR_HOMED", "").lower() if a in "xyz"}
    lost |= {axis.lower() for axis in given if axis.lower() not in homed}
    return Positions(places, lost)
