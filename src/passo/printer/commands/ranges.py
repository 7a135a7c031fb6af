"""Values that are brought within a range, with a note on what is taken."""

from __future__ import annotations


def beyond(code: str, value: float, within: tuple[float, float], unit: str = "") -> str:
    """A note where a value of a command is outside of its range, of which the nearer end is taken;
    else nothing."""
    low, high = within
    taken = min(max(value, low), high)
    if taken == value:
        return ""
    unit = f" {unit}" if unit else ""
    return (
        f"{code}: {value:g}{unit} is not within {low:g} to {high:g}{unit}, {taken:g}{unit} is taken"
    )
