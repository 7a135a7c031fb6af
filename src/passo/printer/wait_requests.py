"""The waits that a command can request, and the destination of its answers."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, TypeAlias

from passo.errors import Problem
from passo.gcode.command import Command


class Stopped(Exception):
    """The wait was stopped or cancelled before its condition was true."""


@dataclass(frozen=True, slots=True)
class WaitForMoves:
    """Waits until all moves so far are done; then calls `then`. With `executed`, the boards of a
    print without consoles must have executed the moves, too."""

    then: Callable[[], object] | None = None
    executed: bool = False


@dataclass(frozen=True, slots=True)
class WaitForQueue:
    """Waits until the plan has free space for the rest of the line, such as an arc of many
    turns."""


@dataclass(frozen=True, slots=True)
class WaitForTemperatures:
    """Waits until all moves are done and these heaters have reached their targets; with `cooling`,
    a heater that is too hot must cool down too."""

    heaters: tuple[str, ...]
    cooling: bool = False


@dataclass(frozen=True, slots=True)
class WaitForReading:
    """Waits until all moves are done and a heater or a sensor reads from `low_c` to `high_c`;
    `heats`: a heater warms up to there."""

    name: str
    low_c: float
    high_c: float
    heats: bool = False


@dataclass(frozen=True, slots=True)
class WaitForUser:
    """Waits until the user continues (M108), or until `seconds` have passed; 0 means no limit."""

    message: str
    seconds: float = 0.0


@dataclass(frozen=True, slots=True)
class WaitForTuning:
    """Waits until `step`, which is called as time passes, returns True. `finish` is called at the
    end, even if the wait ends early."""

    step: Callable[[], bool]
    finish: Callable[[], None]


@dataclass(frozen=True, slots=True)
class WaitForProcedure:
    """Waits until `run` is done. The waiting caller holds the motion lock, and the machine is idle
    at the start. A stored setting, which does not wait, calls `setting` instead."""

    run: Callable[[], Awaitable[None]]
    setting: Callable[[], object] | None = None


@dataclass(frozen=True, slots=True)
class WaitForHoming:
    """Waits until the axes of these letters are homed; without letters, all axes."""

    letters: str


STOPS = {"M112": "machine.emergency-stop", "M410": "machine.stopped"}
"""Commands that end a print at once, and the codes of their errors."""


@dataclass(frozen=True, slots=True)
class Stop:
    """M112 or M410 (`code`) in a line of the program: a print without consoles ends there. A
    program that is only planned continues."""

    code: str
    line: int
    cause: Problem | None = None  # why a macro has stopped the machine

    def problem(self, file: str) -> Problem:
        """The reason for the end of a print of `file`."""
        if self.cause is not None:
            return replace(self.cause, file=file, line=self.line)
        return Problem(STOPS[self.code], file, self.line)


Wait: TypeAlias = (
    WaitForMoves
    | WaitForQueue
    | WaitForTemperatures
    | WaitForReading
    | WaitForUser
    | WaitForTuning
    | WaitForProcedure
    | WaitForHoming
    | Stop
)


class Reply(Protocol):
    """The source of a command, and the destination of its answers."""

    def say(self, text: str) -> None:
        """Sends a line of the answer."""

    def note(self, about: str, text: str, *, again: bool = False) -> None:
        """Sends a line of the answer, once for each subject `about`, or each time if `again`."""

    def no_part(self, code: str, why: str) -> None:
        """Reports that a line of this source has no effect, because the machine does not have the
        part; `why` is a sentence."""

    def with_ok(self, text: str) -> None:
        """Sends a text after `ok` in the same line."""

    def warming(self, text: str) -> None:
        """Sends the temperatures; called once a second while a command waits for them."""

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """Reports that the command was refused: the reason as a sentence, and its problems if
        known."""


Handler: TypeAlias = Callable[[Command, Reply], Wait | None]


def without_effect(code: str, why: str) -> str:
    """The note about a command that has no effect."""
    return f"{code} does nothing here. {why}"


class NullReply:
    """No console listens: answers are dropped."""

    def say(self, text: str) -> None:
        """Drops the text."""

    def note(self, about: str, text: str, *, again: bool = False) -> None:
        """Drops the text."""

    def no_part(self, code: str, why: str) -> None:
        """As a note."""
        self.note(code, without_effect(code, why))

    def with_ok(self, text: str) -> None:
        """Drops the text."""

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """Drops the text."""

    def warming(self, text: str) -> None:
        """Drops the text."""
