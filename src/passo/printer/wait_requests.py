"""The requests that a command may wait for, and the destination of its answers."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from passo.errors import Problem
from passo.gcode.command import Command


class Stopped(Exception):
    """The wait was stopped or cancelled, without its condition."""


@dataclass(frozen=True, slots=True)
class WaitForMoves:
    """Until all moves so far are done; `then` is called after that."""

    then: Callable[[], object] | None = None


@dataclass(frozen=True, slots=True)
class WaitForQueue:
    """Until the plan has free space for the rest of the line, such as an arc of many turns."""


@dataclass(frozen=True, slots=True)
class WaitForTemperatures:
    """Until these heaters have reached their targets, after all moves are done; with `cooling` also
    a heater that is too hot."""

    heaters: tuple[str, ...]
    cooling: bool = False


@dataclass(frozen=True, slots=True)
class WaitForUser:
    """Until the user continues (M108), or `seconds` have passed; 0: without a limit."""

    message: str
    seconds: float = 0.0


@dataclass(frozen=True, slots=True)
class WaitForTuning:
    """Until `step` returns true. It is called as time passes. `finish` is called at the end, also
    if the wait is ended early."""

    step: Callable[[], bool]
    finish: Callable[[], None]


@dataclass(frozen=True, slots=True)
class WaitForProcedure:
    """Until `run` is done. The waiting caller holds the motion lock, and the machine is idle at the
    start."""

    run: Callable[[], Awaitable[None]]


@dataclass(frozen=True, slots=True)
class WaitForHoming:
    """Until these axes are homed: letters, all axes if there are none."""

    letters: str


@dataclass(frozen=True, slots=True)
class Stop:
    """Without end: M112 or M410 (`code`) in this line of a program has ended a print without
    consoles. A plan alone continues."""

    code: str
    line: int


Wait: TypeAlias = (
    WaitForMoves
    | WaitForQueue
    | WaitForTemperatures
    | WaitForUser
    | WaitForTuning
    | WaitForProcedure
    | WaitForHoming
    | Stop
)


class Reply(Protocol):
    """The source of a command, and the destination of its answers."""

    def say(self, text: str) -> None:
        """A line of answer."""

    def note(self, about: str, text: str, *, again: bool = False) -> None:
        """A line of answer, once for each subject, or `again` each time."""

    def with_ok(self, text: str) -> None:
        """Text after `ok` in the same line."""

    def warming(self, text: str) -> None:
        """The temperatures, once a second while a command waits for them."""

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """The command was not carried out: the reason as a sentence, and its problems if known."""


Handler: TypeAlias = Callable[[Command, Reply], Wait | None]


class NullReply:
    """No console listens: answers are dropped."""

    def say(self, text: str) -> None:
        """Drops the text."""

    def note(self, about: str, text: str, *, again: bool = False) -> None:
        """Drops the text."""

    def with_ok(self, text: str) -> None:
        """Drops the text."""

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """Drops the text."""

    def warming(self, text: str) -> None:
        """Drops the text."""
