"""The indices of the core's position lists: X, Y, Z, the active extruder, four further axes."""

from __future__ import annotations

X, Y, Z, E = range(4)
SLOTS = 8


def slot_of_axis(index: int) -> int:
    """The index of axis number `index`, in the order of the core's axes."""
    return index if index < E else index + 1
