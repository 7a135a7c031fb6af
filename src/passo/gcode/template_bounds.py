"""The bounds of a template: how much one call may compute, write and keep."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sized
from itertools import chain
from typing import Any, cast

from jinja2.utils import Cycler, Namespace

# For one call, including all macros that it calls.
MAX_STEPS = 100_000  # less than a second
MAX_LINES, MAX_BYTES = 10_000, 1_000_000  # of its result
MAX_CHARACTERS = 65_536  # of one text within a template
MAX_ITEMS = 100_000  # in one list, including nested lists and their texts, or in a range
_MAX_BITS = 4096  # of an integer
_MAX_WIDTH = 1000  # columns to which a text is padded
_MAX_DIGITS = 30  # decimals that a number is rounded to
_CHARACTERS = 64  # of a text that count as one item of a list, and cost one step
_VISITS = 16  # items of a list that cost one step
_EMPTY: dict[object, object] = {}
_VIEWS = (type(_EMPTY.keys()), type(_EMPTY.values()), type(_EMPTY.items()))
# Values that contain others, which their texts contain too.
_NESTED: tuple[type, ...] = (list, tuple, dict, set, frozenset, Namespace, Cycler, *_VIEWS)
_WIDE = re.compile(r"\d{4,}|\*|\{[^{}]*\{")  # a format with a large width, or a width from a value


class TemplateFault(Exception):
    """An error in a template, with its line (None: in the template as a whole)."""

    def __init__(self, reason: str, line: int | None = None) -> None:
        super().__init__(reason)
        self.reason, self.line = reason, line


class Budget:
    """The steps, bytes and lines that one call may still use, including all macros that it
    calls."""

    def __init__(self) -> None:
        self._steps, self._bytes, self._lines = MAX_STEPS, MAX_BYTES, MAX_LINES

    def spend(self, steps: int) -> None:
        """Raises TemplateFault if no steps are left."""
        self._steps -= steps
        if self._steps < 0:
            text = f"it takes more than {MAX_STEPS:,} steps: loops, calls and filters"
            raise TemplateFault(text)

    def write(self, text: str) -> None:
        """Raises TemplateFault if there is no space for this text."""
        self._bytes -= len(text.encode("utf-8", "replace"))
        self._lines -= text.count("\n")
        if self._bytes < 0:
            raise TemplateFault(f"it becomes more than {MAX_BYTES:,} bytes")
        if self._lines <= 0:
            raise TemplateFault(f"it becomes more than {MAX_LINES:,} lines")


class Bounds:
    """The bounds of one rendering. Every value that a template makes or reads as a whole costs
    steps by its size, so that a call cannot fill the memory either. The methods raise
    TemplateFault."""

    def __init__(self, budget: Budget) -> None:
        """The rendering may write eight times the size of its result, because blocks that are
        stored in variables count too."""
        self.budget, self._characters = budget, 8 * MAX_BYTES

    def write(self, characters: int) -> None:
        """Counts characters that the template writes."""
        self._characters -= characters
        if self._characters < 0:
            raise TemplateFault("it writes too much text")

    def sized(self, value: Any) -> Any:
        """The value, unless it is too large; it costs steps."""
        if isinstance(value, str):
            self.fit(len(value), MAX_CHARACTERS, "characters in a text")
            self.budget.spend(len(value) // _CHARACTERS)
        elif isinstance(value, int):
            self.fit(value.bit_length(), _MAX_BITS, "bits in a number")
        elif isinstance(value, _NESTED):
            size = 0
            for item in _items(cast("object", value)):
                size += 1 + (len(item) // _CHARACTERS if isinstance(item, str) else 0)
                if size > MAX_ITEMS:
                    break
            self.budget.spend(size // _VISITS)
            self.fit(size, MAX_ITEMS, "items in a list")
        return cast("object", value)

    def read(self, value: Any) -> Any:
        """Like `sized`; the items of a list that is read once cost a step each."""
        if isinstance(value, Iterator):
            return self.counted(cast("Iterator[object]", value))
        return self.sized(value)

    def counted(self, values: Iterable[Any], written: int = 0) -> Iterator[Any]:
        """The items of a loop; each of them costs a step, and the `written` characters of the
        loop's body."""
        for value in values:
            self.budget.spend(1)
            self.write(written)
            yield value

    def grow(self, owner: Sized, added: Iterable[Any]) -> None:
        """Checks that a list or a table may grow by what is `added`."""
        count = 1 + sum(
            len(one) for one in added if isinstance(one, Sized) and isinstance(one, _NESTED)
        )
        self.fit(len(owner) + count, MAX_ITEMS, "items in a list")

    def method(self, owner: Sized, name: str, given: Iterable[Any]) -> None:
        """Checks a method of a list or a table with its arguments."""
        self.grow(owner, given)
        if isinstance(owner, list | tuple) and name not in ("append", "pop"):
            self.budget.spend(len(cast("Sized", owner)) // _VISITS)

    def texts(self, values: Iterable[Any], between: str) -> list[str]:
        """The values as texts, which may be joined."""
        texts: list[str] = []
        size = 0
        for value in values:
            self.budget.spend(1)
            texts.append(str(self.sized(value)))
            size += len(texts[-1]) + len(between)
            self.fit(size, MAX_CHARACTERS + len(between), "characters in a text")
        return texts

    def replaceable(self, text: str, old: str, new: str) -> None:
        """Checks that all `old` in a text may be replaced."""
        size = len(text) + (text.count(old) + (not old)) * len(new)
        self.fit(size, MAX_CHARACTERS, "characters in a text")

    def product(self, left: Any, right: Any) -> None:
        """Checks a product, which may repeat a text or a list."""
        for one, other in ((left, right), (right, left)):
            if isinstance(one, Sized) and isinstance(other, int):
                most = MAX_CHARACTERS if isinstance(one, str) else MAX_ITEMS
                self.fit(len(one) * other, most, "items or characters")

    def power(self, base: Any, exponent: Any) -> None:
        """Checks a power."""
        bits = base.bit_length() if isinstance(base, int) else 1
        size = bits * abs(exponent) if isinstance(exponent, int | float) else 0
        self.fit(size, _MAX_BITS, "bits in a number")

    def range(self, *args: int) -> range:
        """The `range` of templates."""
        for number in args:
            self.fit(abs(number), 2**31, "as a bound of a range")
        found = range(*args)
        self.fit(len(found), MAX_ITEMS, "items")
        return found

    def columns(self, width: Any) -> None:
        """Checks the width of a text: a number of columns, or the text itself."""
        self.fit(len(width) if isinstance(width, str) else width, _MAX_WIDTH, "columns")

    def decimals(self, count: Any) -> None:
        """Checks how many decimals a number is rounded to."""
        self.fit(abs(count), _MAX_DIGITS, "decimals")

    def form(self, form: str) -> None:
        """Checks a format."""
        if _WIDE.search(form):
            raise TemplateFault(f"a format pads to more than {_MAX_WIDTH} columns: {form:.40}")

    def fit(self, size: float, most: int, what: str) -> None:
        """Checks a size."""
        if size > most:
            raise TemplateFault(f"it makes more than {most:,} {what}")


def _items(value: object) -> Iterator[object]:
    """All values within a value; a value in two places counts twice."""
    rest = [_within(value)]
    while rest:
        for item in rest[-1]:
            yield item
            if isinstance(item, _NESTED):
                rest.append(_within(item))
                break
        else:
            rest.pop()


def _within(value: object) -> Iterator[object]:
    if isinstance(value, Namespace):
        value = cast("object", object.__getattribute__(value, "_Namespace__attrs"))
    if isinstance(value, dict):
        pairs = cast("dict[object, object]", value)
        return chain(pairs, pairs.values())
    if isinstance(value, Cycler):
        value = value.items
    return iter(cast("Iterable[object]", value))
