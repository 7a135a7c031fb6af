"""The positions that homing gives to axes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from passo.config.motor_roles import axis_order

if TYPE_CHECKING:
    from passo.motion.offsets import Offsets
    from passo.motion.rig import Rig


class HomedPositions:
    """Sets the positions of axes that are homed. `offset_mm` are the home offsets of M206, by axis,
    at the last homing."""

    def __init__(self, rig: Rig, offsets: Offsets) -> None:
        self._rig, self._offsets = rig, offsets
        self._axes = axis_order(rig.machine.axes)
        self.offset_mm: dict[str, float] = {}

    def set(self, places: Mapping[str, float]) -> None:
        """The axes are homed, at these positions of the machine, mm."""
        self._rig.job.axes.set([(self._axes.index(n), at) for n, at in places.items()], homed=True)
        self._rig.positions.confirm(places)
        self._offsets.homed(places)
        self._rig.positions.known.update(places)

    def set_with_offsets(self, places: Mapping[str, float]) -> None:
        """Like `set`, for positions of endstops, to which the home offsets are added."""
        self.offset_mm |= {name: self._offsets.home_mm[name] for name in places}
        self.set({name: at + self.offset_mm[name] for name, at in places.items()})
