"""Faults that can be injected into a board: their interface and their syntax."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from passo.errors import CommandError

NO_FAULT = "none"
_TIME = r"(\d+(?:\.\d*)?)\s*(s|min)?"
_ORDER = re.compile(rf"\s*([\w-]+)\s*=\s*([\w:.]+?)\s*(?:@\s*{_TIME})?\s*(?:\+\s*{_TIME})?\s*")


class FaultInjector(Protocol):
    """Injects faults into the parts of boards. Each part has at most one fault at a time."""

    @property
    def values(self) -> Mapping[str, tuple[str, ...]]:
        """The possible faults by the name of the part; the first is `none`."""
        ...

    @property
    def active(self) -> Mapping[str, str]:
        """The parts that have a fault now, with the fault."""
        ...

    def check(self, part: str, value: str) -> None:
        """Raises CommandError for a part or a fault that does not exist."""
        ...

    def inject(self, part: str, value: str) -> None:
        """Simulates the fault `value` of a part from now on; `none` ends it. Raises CommandError if
        the part or the fault does not exist."""
        ...


@dataclass(frozen=True, slots=True)
class FaultOrder:
    """A fault that a part gets after `start` seconds of print time, for `duration` seconds or
    permanently."""

    part: str
    value: str
    after_s: float = 0.0
    for_s: float | None = None

    @classmethod
    def parse(cls, text: str) -> FaultOrder:
        """`PART=FAULT[@START][+DURATION]`, times with `s` or `min`, for example
        `hotend-sensor=open@60s+30s`. Raises CommandError."""
        found = _ORDER.fullmatch(text)
        if found is None:
            limit = "PART=FAULT[@START][+DURATION], such as hotend-sensor=open@60s+30s"
            raise CommandError.of("command.fault-order", value=text, limit=limit)
        after_s = _seconds(found[3], found[4]) or 0.0
        return cls(found[1], found[2], after_s, _seconds(found[5], found[6]))


def _seconds(number: str | None, unit: str | None) -> float | None:
    return None if number is None else float(number) * (60.0 if unit == "min" else 1.0)
