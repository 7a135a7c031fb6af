"""Values that are clamped to a range, with a note."""

from __future__ import annotations


def beyond(code: str, value: float, within: tuple[float, float], unit: str = "") -> str:
    """A note if a value of a command is outside of its range and is clamped to the nearest limit;
    else an empty text."""
    low, high = within
    taken = min(max(value, low), high)
    if taken == value:
        return ""
    unit = f" {unit}" if unit else ""
    return (
        f"{code}: {value:g}{unit} is not within {low:g} to {high:g}{unit}, {taken:g}{unit} is taken"
    )
