"""The states of the file that a printer prints, and the ways between them."""

from __future__ import annotations

from enum import Enum


class JobState(Enum):
    """What becomes of the selected file."""

    NONE = "no file is selected"
    READY = "a file is selected"
    APPROACHING = "the machine goes to the place where the print resumes"
    PRINTING = "printing"
    PAUSED = "paused"
    RETURNING = "the pause is over, and the nozzle returns to the print"
    FAILED = "the print has stopped at a line, and can be resumed behind it"

    @property
    def prints(self) -> bool:
        """The print goes on, or is about to."""
        return self in (JobState.PRINTING, JobState.RETURNING)

    @property
    def active(self) -> bool:
        """A print is under way, or paused."""
        return self.prints or self is JobState.PAUSED


_S = JobState
TRANSITIONS: dict[JobState, frozenset[JobState]] = {
    # M23 selects a file.
    _S.NONE: frozenset({_S.READY}),
    # M22 releases it; M1000 selects it and goes to the place where its print resumes; M24 starts.
    _S.READY: frozenset({_S.NONE, _S.APPROACHING, _S.PRINTING}),
    # The machine is there, or did not get there.
    _S.APPROACHING: frozenset({_S.READY}),
    # M25 or a failed heater pauses; the end, M524, or what fails.
    _S.PRINTING: frozenset({_S.PAUSED, _S.READY, _S.FAILED}),
    # M24 before the machine has braked, or after; M524; M999 after a halt.
    _S.PAUSED: frozenset({_S.PRINTING, _S.RETURNING, _S.READY, _S.FAILED}),
    # The nozzle is back; another pause, also where it cannot return; M524; a stop.
    _S.RETURNING: frozenset({_S.PRINTING, _S.PAUSED, _S.READY, _S.FAILED}),
    # Another file or M524; M22; M24 behind the line that has failed.
    _S.FAILED: frozenset({_S.READY, _S.NONE, _S.PRINTING}),
}
