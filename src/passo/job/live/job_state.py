"""The states of the file that a printer prints, and of its pause, and their transitions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum
from typing import Generic, TypeVar

_State = TypeVar("_State", bound=Enum)


class States(Generic[_State]):
    """A state, which changes along the transitions of a table. `now` is the state; `watchers` are
    called with the old and the new one."""

    def __init__(self, first: _State, table: Mapping[_State, frozenset[_State]]) -> None:
        self.now: _State = first
        self._table = table
        self.watchers: list[Callable[[_State, _State], None]] = []

    def enter(self, state: _State) -> None:
        """Changes the state and notifies all watchers; does nothing if the state stays the same.
        Raises RuntimeError for a transition that the table does not have."""
        was = self.now
        if state is was:
            return
        if state not in self._table[was]:
            raise RuntimeError(f"a print does not go from {was.name} to {state.name}")
        self.now = state
        for watcher in self.watchers:
            watcher(was, state)


class JobState(Enum):
    """The state of the selected file."""

    NONE = "no file is selected"
    READY = "a file is selected"
    STARTING = "the file starts as soon as its last print has ended"
    APPROACHING = "the machine moves to the position where the print resumes"
    PRINTING = "printing"
    PAUSED = "paused"
    RETURNING = "the pause is over, and the nozzle returns to the print"
    FAILED = "the print has stopped at a line, and can be resumed after it"

    @property
    def prints(self) -> bool:
        """Whether the print is running, or about to run."""
        return self in (JobState.PRINTING, JobState.RETURNING)

    @property
    def active(self) -> bool:
        """Whether a print is running or paused."""
        return self.prints or self is JobState.PAUSED


_S = JobState
TRANSITIONS: dict[JobState, frozenset[JobState]] = {
    # M23 selects a file.
    _S.NONE: frozenset({_S.READY}),
    # M22 releases the file; M1000 approaches the position at which its print resumes; M24 starts
    # it.
    _S.READY: frozenset({_S.NONE, _S.STARTING, _S.APPROACHING, _S.PRINTING}),
    # M24 while the cancelled or stopped print releases the machine. M22, and M23 or M524, before it
    # has done so.
    _S.STARTING: frozenset({_S.NONE, _S.READY, _S.PRINTING}),
    # The machine has reached the resume position, or could not.
    _S.APPROACHING: frozenset({_S.READY}),
    # M25 or a failed heater pauses the print; its end, M524 or a failure ends it.
    _S.PRINTING: frozenset({_S.PAUSED, _S.READY, _S.FAILED}),
    # M24 before the machine has braked, or after; M524; M999 after a halt.
    _S.PAUSED: frozenset({_S.PRINTING, _S.RETURNING, _S.READY, _S.FAILED}),
    # The nozzle has returned; another pause, or the nozzle cannot return; M524; a stop.
    _S.RETURNING: frozenset({_S.PRINTING, _S.PAUSED, _S.READY, _S.FAILED}),
    # Another file or M524; M22; M24 continues after the failed line.
    _S.FAILED: frozenset({_S.READY, _S.NONE, _S.STARTING, _S.PRINTING}),
}


class PauseState(Enum):
    """The state of the pause of a print. While the machine homes, the print is paused and not yet
    suspended."""

    NONE = "the print is not suspended"
    ASKED = "the print will pause as soon as it resumes"
    SUSPENDED = "the machine has braked, and the rest of the print is suspended"
    PARKED = "the nozzle is parked"


PAUSES: dict[PauseState, frozenset[PauseState]] = {
    # M25 while the machine approaches the resume position; M25 during the print.
    PauseState.NONE: frozenset({PauseState.ASKED, PauseState.SUSPENDED}),
    # The position is reached, M24 or a failure.
    PauseState.ASKED: frozenset({PauseState.NONE}),
    # The nozzle parks; M24 before that, or the nozzle has returned, or a stop.
    PauseState.SUSPENDED: frozenset({PauseState.PARKED, PauseState.NONE}),
    # The nozzle has returned; a stop, or another print begins.
    PauseState.PARKED: frozenset({PauseState.SUSPENDED, PauseState.NONE}),
}
