"""What is left of a program when objects are cancelled: a reader of its text in plain Python."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import NamedTuple

_WORD = re.compile(r"([A-Z])([-+]?\d*\.?\d+)")
_NAME = re.compile(r"NAME=(?:\"([^\"]*)\"|(\S+))")
_FEED = "F"
Point = tuple[float, float, float]


class Printed(NamedTuple):
    """A line that lays filament: from where to where, mm, and how much of it."""

    line: int
    start: Point
    end: Point
    filament_mm: float


class Reading(NamedTuple):
    """Of one program: the lines of live objects that lay filament, the lines of cancelled ones, by
    how much filament is drawn back before each line and after the last, and the program's position
    and E at its end."""

    printed: list[Printed]
    skipped: set[int]
    drawn_mm: dict[int, float]
    at: Point
    e: float


def read(text: str, cancelled: Collection[int | str], retraction_mm: float = 3.0) -> Reading:
    """Objects are numbers of M486 or names of EXCLUDE_OBJECT_START. Straight moves, G10 without a
    hop, G20, G21, G90 to G92, M82 and M83 are understood."""
    at, zero = {"X": 0.0, "Y": 0.0, "Z": 0.0}, {"X": 0.0, "Y": 0.0, "Z": 0.0}
    e = drawn = 0.0
    unit, absolute, absolute_e, back = 1.0, True, True, False
    current: int | str | None = None
    printed: list[Printed] = []
    skipped: set[int] = set()
    drawn_mm: dict[int, float] = {}
    number = 0
    for number, raw in enumerate(text.splitlines(), 1):
        line = raw.partition(";")[0].strip()
        drawn_mm[number] = drawn
        if line.startswith("EXCLUDE_OBJECT_START"):
            found = _NAME.search(raw)
            assert found is not None
            current = found[1] or found[2]
        elif line.startswith("EXCLUDE_OBJECT_END"):
            current = None
        elif line.startswith("M486 S"):
            found = re.match(r"M486 S(-?\d+)", line)
            assert found is not None
            current = None if found[1].startswith("-") else int(found[1])
        if current in cancelled:
            skipped.add(number)
        code, _, rest = line.partition(" ")
        words = {letter: float(value) for letter, value in _WORD.findall(rest)}
        if code in ("G90", "G91"):
            absolute = code == "G90"
        elif code in ("M82", "M83"):
            absolute_e = code == "M82"
        elif code in ("G20", "G21"):
            unit = 25.4 if code == "G20" else 1.0
        elif code == "G92":
            for letter, value in words.items():
                if letter == "E":
                    e = value * unit
                else:
                    zero[letter] = at[letter] - value * unit
        elif code in ("G10", "G11"):
            if back != (code == "G10"):
                drawn = max(0.0, drawn + (retraction_mm if code == "G10" else -retraction_mm))
            back = code == "G10"
        elif code in ("G0", "G1"):
            before = dict(at)
            for letter in "XYZ":
                if letter in words:
                    mm = words[letter] * unit
                    at[letter] = mm + (zero[letter] if absolute else at[letter])
            by = 0.0
            if "E" in words:
                mm = words["E"] * unit
                by = mm - e if absolute and absolute_e else mm
                e += by
            drawn = max(0.0, drawn - by)
            moves = before != at
            if by > 1e-9 and moves and number not in skipped:
                printed.append(Printed(number, _point(before), _point(at), by))
    drawn_mm[number + 1] = drawn
    return Reading(printed, skipped, drawn_mm, _point(at), e)


def _point(at: dict[str, float]) -> Point:
    return at["X"], at["Y"], at["Z"]
