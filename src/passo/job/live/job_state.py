"""The states of the file that a printer prints, and their transitions."""

from __future__ import annotations

from enum import Enum


class JobState(Enum):
    """The state of the selected file."""

    NONE = "no file is selected"
    READY = "a file is selected"
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
    _S.READY: frozenset({_S.NONE, _S.APPROACHING, _S.PRINTING}),
    # The machine has reached the resume position, or could not.
    _S.APPROACHING: frozenset({_S.READY}),
    # M25 or a failed heater pauses the print; its end, M524 or a failure ends it.
    _S.PRINTING: frozenset({_S.PAUSED, _S.READY, _S.FAILED}),
    # M24 before the machine has braked, or after; M524; M999 after a halt.
    _S.PAUSED: frozenset({_S.PRINTING, _S.RETURNING, _S.READY, _S.FAILED}),
    # The nozzle has returned; another pause, or the nozzle cannot return; M524; a stop.
    _S.RETURNING: frozenset({_S.PRINTING, _S.PAUSED, _S.READY, _S.FAILED}),
    # Another file or M524; M22; M24 continues after the failed line.
    _S.FAILED: frozenset({_S.READY, _S.NONE, _S.PRINTING}),
}
