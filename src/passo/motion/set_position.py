"""The positions that G92 gives axes and motors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.motor_roles import axis_order
from passo.errors import CommandError
from passo.geometry.base import Unreachable
from passo.motion.axis_slots import E

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig
    from passo.gcode.command import Command


def place_of_axes(command: Command, machine: MachineConfig, job: _core.Job) -> dict[int, float]:
    """The new positions of axes that are not homed, in mm by axis number; the interpreter handles
    homed axes. Raises CommandError if the motors cannot reach a position, or if it is far outside
    the range of its axis."""
    axes = axis_order(machine.axes)
    places = {axes.index(k.lower()): v for k, v in command.words().items()}
    x, y, z = (places.get(i, at) for i, at in enumerate(job.machine_position[:E]))
    try:
        machine.geometry.inverse((x, y, z))
    except Unreachable as error:
        raise _nowhere(command, error) from None
    return _near(places, machine)


def place_of_actuators(
    command: Command, machine: MachineConfig, job: _core.Job
) -> dict[int, float]:
    """Like `place_of_axes`, for letters of motors: the nozzle position follows from the positions
    of all motors. Empty without such a letter. Raises CommandError if no nozzle position belongs to
    them, or if the position of another motor is unknown."""
    geometry, words = machine.geometry, command.words()
    given = {n: words[n.upper()] for n in geometry.actuators if n.upper() in words}
    if not given:
        return {}
    locked = [i for i in job.locked_axes if i < E]
    if locked and len(given) < len(set(geometry.actuators) - {"z"}):
        raise CommandError.of("input.not-homed", axis="XYZ"[locked[0]])
    try:
        x, y, z = job.machine_position[:E]
        known = dict.fromkeys(geometry.actuators, z)
        if not locked:
            nozzle = x, y, job.bed.nozzle_height(x, y, z)
            known = dict(zip(geometry.actuators, geometry.inverse(nozzle), strict=True))
        point = geometry.forward([*(known | given).values()])
        geometry.inverse(point)  # a delta's rods also meet at places that its nozzle must not reach
        x, y, height = point
        point = x, y, job.bed.plan_z(x, y, height)
    except Unreachable as error:
        raise _nowhere(command, error) from None
    ways = 3 if geometry.lifts_together or 2 not in locked else 2
    return _near(dict(list(enumerate(point))[:ways]), machine)


def _near(places: dict[int, float], machine: MachineConfig) -> dict[int, float]:
    """Raises CommandError for a position that is outside an axis by more than the length of the
    axis."""
    names = axis_order(machine.axes)
    for i, mm in places.items():
        low, high = (axis := machine.axes[names[i]]).min_mm, axis.max_mm
        if not 2 * low - high <= mm <= 2 * high - low:
            limit = f"{2 * low - high:g} to {2 * high - low:g} mm"
            raise CommandError.bad_value(names[i].upper(), mm, limit)
    return places


def _nowhere(command: Command, error: Unreachable) -> CommandError:
    limit = f"a position within reach, but {error}"
    return CommandError.of("command.value", axis="G92", value=command.text.strip(), limit=limit)
