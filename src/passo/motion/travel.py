"""Returns the nozzle to a place that it has left: first above it, and then down."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from passo._core import Within
from passo.motion.axis_slots import Z

if TYPE_CHECKING:
    from passo.motion.rig import Rig


def go_over(rig: Rig, place: Mapping[int, float], speed_mm_s: float) -> bool:
    """Adds moves that bring the nozzle above `place` (machine mm by axis index). Arms that lift
    together reach only the middle when they are near the top, so the nozzle first descends: to the
    parking height above the place, or to the place's own height if the parking height is too near
    the top. False if the arms do not reach the place."""
    machine, queue = rig.machine, rig.queue
    across = {slot: mm for slot, mm in place.items() if slot != Z}
    if Z not in place or not machine.geometry.lifts_together:
        return queue.move(across, speed_mm_s, Within.REACH)
    raise_mm = machine.park.raise_mm if machine.park else 0.0
    for height in (place[Z] + raise_mm, place[Z]):
        if rig.job.machine_position[Z] > height:
            queue.move({Z: height}, math.inf, Within.REACH)
        if queue.move(across, speed_mm_s, Within.REACH):
            return True
    return False


def go_back(rig: Rig, place: Mapping[int, float], speed_mm_s: float) -> bool:
    """Adds moves that bring the nozzle above a place and then down to it. False if the arms do not
    reach it."""
    over = go_over(rig, place, speed_mm_s)
    return over and (Z not in place or rig.queue.move({Z: place[Z]}, math.inf, Within.REACH))
