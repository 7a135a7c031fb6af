"""Moves to places that the machine file names, before or after homing and probing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Literal

from pydantic import Field

from passo.config.types import Model, Name, Position, Speed

Hook = Literal["before_homing", "after_homing", "before_probing", "after_probing"]


class PredefinedMove(Model):
    """A straight move of the nozzle to a place. MOVE_TO makes it, and so does G28 or a measurement
    of the bed, if `hook` names one of them. Moves of the same hook follow each other by `priority`,
    then in the order of this file."""

    position_mm: Annotated[dict[Name, Position], Field(min_length=1)]
    """Where each of these axes goes, such as `{ x = 110, y = 110 }`; other axes stay."""
    relative: bool = False
    """Whether the positions are distances from where the nozzle is."""
    speed_mm_s: Speed = 200.0
    """The speed; the limits of the axes hold, too."""
    hook: Hook | None = None
    """When the printer makes the move by itself: `before_homing` of any axis (then it has to be
    relative, and a homed axis stays within its limits), `after_homing` of all axes by a G28
    without letters, `before_probing` or `after_probing` of a bed by G29, G32 or
    BED_MESH_CALIBRATE, if that succeeds. If not given, only MOVE_TO makes it."""
    priority: Annotated[int, Field(ge=0, le=1000)] = 10
    """Moves of a hook with a lower number come first."""
    enabled: bool = True
    """Whether the hook makes the move."""


def hooked(moves: Mapping[str, PredefinedMove], hook: Hook) -> Iterator[tuple[str, PredefinedMove]]:
    """The enabled moves of a hook with their names, in the order in which they are made."""
    own = [(name, move) for name, move in moves.items() if move.enabled and move.hook == hook]
    yield from sorted(own, key=lambda item: item[1].priority)
