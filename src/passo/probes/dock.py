"""A probe that the head fetches from a dock and returns to it."""

from __future__ import annotations

from typing import ClassVar, Literal

from passo.config.types import Pair, Position, Speed
from passo.probes.base import Head, Mechanism, SwitchProbe, not_deployed, not_stowed


class DockProbe(SwitchProbe):
    """A probe that magnets hold. Before a run the head fetches it: at `dock_height_mm` it moves to
    `approach_mm`, into the dock, and back with the probe. After the run the head returns the probe
    to the dock on the same path, and moves to `leave_mm` without it."""

    travels_to_deploy: ClassVar[bool] = True
    kind: Literal["dock"]
    """Fetched from a dock."""
    approach_mm: Pair
    """X and Y of the nozzle before the dock."""
    dock_mm: Pair
    """X and Y of the nozzle with the probe in the dock."""
    leave_mm: Pair
    """X and Y of the nozzle that it leaves to without the probe."""
    dock_height_mm: Position = 20.0
    """Z of the nozzle at the dock, and on the way there; not below `start_mm`."""
    dock_mm_s: Speed = 30.0
    """The speed into the dock and out of it."""
    check: bool = True
    """Whether the probe is triggered while it is not at the head, as a switch that opens at the
    touch is. Then Passo checks that it has it, and that it has left it."""

    @property
    def mechanism(self) -> Mechanism:
        """A dock."""
        (x, y), (to_x, to_y) = self.dock_mm, self.leave_mm
        return Mechanism("dock", dock_mm=(x, y, self.dock_height_mm), leave_mm=(to_x, to_y))

    async def _into_dock(self, head: Head) -> None:
        height = self.dock_height_mm
        if head.z_mm < height:
            await head.move(self.lift_mm_s, z=height)
        await self._travel(head, self.approach_mm, self.travel_mm_s)
        await head.move(self.lift_mm_s, z=height)
        await self._travel(head, self.dock_mm, self.dock_mm_s)

    async def _travel(self, head: Head, place: list[float], speed_mm_s: float) -> None:
        x, y = place
        await head.move(speed_mm_s, x=x, y=y)

    async def deploy(self, head: Head) -> None:
        """Fetches the probe."""
        if self.check and not head.triggered():
            return  # the probe is at the head already
        await self._into_dock(head)
        await self._travel(head, self.approach_mm, self.dock_mm_s)
        if self.check and head.triggered():
            raise not_deployed("triggered", "open once the head has fetched the probe")

    async def stow(self, head: Head) -> None:
        """Returns the probe to the dock."""
        if self.check and head.triggered():
            return  # the probe is not at the head
        await self._into_dock(head)
        await self._travel(head, self.leave_mm, self.dock_mm_s)
        if self.check and not head.triggered():
            raise not_stowed("open", "triggered once the head has left the probe in its dock")
