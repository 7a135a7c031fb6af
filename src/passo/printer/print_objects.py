"""The objects that a program labels."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, cast

from passo.printer.status import PrintObject

if TYPE_CHECKING:
    from passo import _core


def objects_of(job: _core.Job) -> tuple[PrintObject, ...]:
    """The objects of the program that a job reads, by their numbers."""
    return tuple(
        PrintObject(i, name, cancelled, _point(centre), _outline(outline))
        for i, (name, cancelled, centre, outline) in enumerate(job.objects)
    )


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
