"""Numbers in the configurations of other firmwares: finite, and of a size with which the importers
can calculate."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from passo.config.importing.draft import Place, bad

if TYPE_CHECKING:
    from passo.config.importing.draft import Draft

_LARGEST_COUNT = 10_000_000
LARGEST, SMALLEST = 1e12, 1e-12  # of an absolute value; 0 is a number too
NUMBER = f"a number from -{LARGEST:g} to {LARGEST:g}"


def in_range(value: float) -> bool:
    """Whether a number is finite and of a size that a setting of a printer may have."""
    return value == 0 or SMALLEST <= abs(value) <= LARGEST


def number_of(text: str) -> float:
    """The number in a text. Raises ValueError for any other text, and for a number that is not in
    range."""
    value = float(text)
    if not in_range(value):
        raise ValueError(text)
    return value


def plain(value: float) -> float:
    """A number without the rounding error of its calculation."""
    return float(f"{value:.10g}")


class Read(NamedTuple):
    """A number that was read: the name of the option that has it, and its place."""

    value: float
    name: str
    place: Place

    def whole(self, minimum: int = 0, maximum: int = _LARGEST_COUNT) -> int:
        """The number as a whole number. Raises ConfigError for a fraction, and for a number that
        is not within the limits, which are included."""
        if not minimum <= self.value <= maximum or self.value != int(self.value):
            limit = f"a whole number from {minimum} to {maximum}"
            raise bad(self.place, self.name, f"{self.value:g}", limit)
        return int(self.value)

    def at_most(self, maximum: int, draft: Draft) -> int:
        """The number as a whole number of at least 0. A larger one becomes the maximum, which is
        reported. Raises ConfigError for a fraction."""
        value = self.whole(0, 1_000_000)
        if value > maximum:
            draft.changed(self.place, f"{self.name} {value}", f"Passo has {maximum} at most")
        return min(value, maximum)
