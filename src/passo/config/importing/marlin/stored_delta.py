"""The geometry of a delta that Marlin has stored: M665 and M666 of an answer to M503."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.importing.draft import bad
from passo.config.importing.numbers import plain
from passo.geometry.delta import ANGLES, rise_mm

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.importing.draft import Draft, Place

_TOWERS = "abc"


def put_delta(draft: Draft, words: Mapping[str, float], place: Place) -> None:
    """Sets the geometry of M665: L is the rod, R the radius, H the height, X, Y and Z turn the
    towers, and A, B and C change their rods. The endstops keep their trims. Raises ConfigError for
    rods that are too short."""
    trims = _trims(draft)
    rods, angles = draft.numbers(("geometry", "rods")), draft.numbers(("geometry", "angles"))
    if "L" in words:
        more = [words.get(letter, 0.0) for letter in "ABC"] if "C" in words else [0.0] * 3
        rods = [plain(words["L"] + each) for each in more]
    for index, letter in enumerate("XYZ"):
        if letter in words:
            angles[index] = ANGLES[index] + words[letter]
    if "R" in words:
        draft.put(("geometry", "radius"), words["R"], place)
    draft.put(("geometry", "rods"), [*rods], place)
    draft.put(("geometry", "angles"), [*angles], place)
    radius = draft.number(("geometry", "radius"))
    if min(rods) <= radius:
        raise bad(place, "M665 L", f"{min(rods):g}", f"more than the radius of {radius:g} mm")
    if "H" in words:
        draft.put(("axes", "z", "max_mm"), words["H"], place)
        draft.put(("axes", "z", "home_mm"), words["H"], place)
    _put_trims(draft, trims, place)


def put_trims(draft: Draft, words: Mapping[str, float], place: Place) -> None:
    """Sets the trims of the endstops, from M666. A trim below 0 puts an endstop higher."""
    trims = [words.get(letter, own) for letter, own in zip("XYZ", _trims(draft), strict=True)]
    _put_trims(draft, trims, place)


def _put_trims(draft: Draft, trims: list[float], place: Place) -> None:
    for tower, top, trim in zip(_TOWERS, _tops(draft), trims, strict=True):
        draft.put(("homing", tower, "position"), round(top - trim, 6), place)


def _trims(draft: Draft) -> list[float]:
    ends = [draft.number(("homing", tower, "position")) for tower in _TOWERS]
    return [top - end for top, end in zip(_tops(draft), ends, strict=True)]


def _tops(draft: Draft) -> list[float]:
    """The heights of the carriages with the nozzle in the middle, at the top."""
    radius, height = draft.number(("geometry", "radius")), draft.number(("axes", "z", "home_mm"))
    return [height + rise_mm(rod, radius) for rod in draft.numbers(("geometry", "rods"))]
