"""What a command may wait for, and where its answers go."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from passo.errors import Problem
from passo.gcode.command import Command


class Stopped(Exception):
    """What was waited for will not come: somebody has stopped or cancelled it."""


@dataclass(frozen=True, slots=True)
class Still:
    """Until the machine has done all moves so far; `then` is what may be done only now."""

    then: Callable[[], object] | None = None


@dataclass(frozen=True, slots=True)
class Room:
    """Until the plan has room for the rest of the line, an arc of many turns."""


@dataclass(frozen=True, slots=True)
class Temperatures:
    """Until these heaters have reached their targets, the machine standing still; `cooling` waits
    for a heater that is too hot as well."""

    heaters: tuple[str, ...]
    cooling: bool = False


@dataclass(frozen=True, slots=True)
class Person:
    """Until somebody says go on, or `seconds` (0: for ever) have passed."""

    message: str
    seconds: float = 0.0


@dataclass(frozen=True, slots=True)
class Tuning:
    """Until `step`, which is called as time passes, is true; then, or when the wait is ended,
    `finish`."""

    step: Callable[[], bool]
    finish: Callable[[], None]


@dataclass(frozen=True, slots=True)
class Procedure:
    """Until `run` is done. The waiting caller holds the motion lock, and the machine is idle at the
    start."""

    run: Callable[[], Awaitable[None]]


@dataclass(frozen=True, slots=True)
class Homing:
    """Until these axes (letters; all if none) are at home."""

    letters: str


@dataclass(frozen=True, slots=True)
class Stop:
    """For ever: M112 or M410 (`code`) in this line of a program has ended a print without consoles.
    A plan alone goes on."""

    code: str
    line: int


Wait: TypeAlias = Still | Room | Temperatures | Person | Tuning | Procedure | Homing | Stop


class Reply(Protocol):
    """Where a command came from, and where its answers go."""

    def say(self, text: str) -> None:
        """A line of answer."""

    def note(self, about: str, text: str) -> None:
        """A line of answer, once for whatever it is about."""

    def with_ok(self, text: str) -> None:
        """Text that stands behind `ok` in the same line."""

    def warming(self, text: str) -> None:
        """The temperatures, once a second while a command waits for them."""

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """The command was not carried out: why, in words, and the problems if they are known."""


Handler: TypeAlias = Callable[[Command, Reply], Wait | None]


class Silence:
    """Nobody listens: answers are dropped."""

    def say(self, text: str) -> None:
        """Drops the text."""

    def note(self, about: str, text: str) -> None:
        """Drops the text."""

    def with_ok(self, text: str) -> None:
        """Drops the text."""

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """Drops the text."""

    def warming(self, text: str) -> None:
        """Drops the text."""
