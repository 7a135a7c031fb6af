"""The objects that a program labels."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

from passo.printer.status import PrintObject

if TYPE_CHECKING:
    from passo import _core


def objects_of(job: _core.Job) -> tuple[PrintObject, ...]:
    """The objects of the program that a job reads, by their numbers."""
    return tuple(
        PrintObject(i, name, cancelled, _point(centre), _outline(outline))
        for i, (name, cancelled, centre, outline) in enumerate(job.objects.all)
    )


def covered(objects: Sequence[PrintObject]) -> tuple[float, float, float, float] | None:
    """The rectangle around the outlines of all objects that are not cancelled: X and Y of its first
    corner, then of the opposite one, mm. None if none has an outline."""
    places = [at for o in objects if not o.cancelled for at in o.outline_mm]
    if not places:
        return None
    xs, ys = [x for x, _ in places], [y for _, y in places]
    return min(xs), min(ys), max(xs), max(ys)


def _point(text: str) -> tuple[float, float] | None:
    """Parses X,Y; None for any other text."""
    try:
        x, y = map(float, text.split(","))
    except ValueError:
        return None
    return x, y


def _outline(text: str) -> tuple[tuple[float, float], ...]:
    """Parses [[X,Y],...]; empty for any other text."""
    try:
        found = cast("list[Any]", json.loads(text))
        return tuple((float(x), float(y)) for x, y in found)
    except (ValueError, TypeError, RecursionError):
        return ()
