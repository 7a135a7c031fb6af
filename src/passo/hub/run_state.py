"""The states of a run, and its transitions."""

from __future__ import annotations

from enum import Enum


class RunState(Enum):
    """A run is one print of a job on one printer. The values are stored and shown."""

    ASSIGNED = "assigned"  # the printer is chosen, nothing is sent
    UPLOADING = "uploading"  # the file is being sent
    UPLOADED = "uploaded"  # the printer has the file; the run waits for power
    STARTING = "starting"  # the start is sent; the printer may or may not have it
    PRINTING = "printing"  # the printer has confirmed the start; it may be paused
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"

    @property
    def over(self) -> bool:
        """Whether nothing follows."""
        return not TRANSITIONS[self]


_S = RunState

# A connection that is lost leads back to ASSIGNED only before the start is sent. From STARTING on,
# only the printer says what becomes of the run; so a run starts at most once.
TRANSITIONS: dict[RunState, frozenset[RunState]] = {
    _S.ASSIGNED: frozenset({_S.UPLOADING, _S.FAILED, _S.CANCELLED}),
    _S.UPLOADING: frozenset({_S.UPLOADED, _S.ASSIGNED, _S.FAILED, _S.CANCELLED}),
    _S.UPLOADED: frozenset({_S.STARTING, _S.ASSIGNED, _S.FAILED, _S.CANCELLED}),
    _S.STARTING: frozenset({_S.PRINTING, _S.DONE, _S.FAILED, _S.CANCELLED}),
    _S.PRINTING: frozenset({_S.DONE, _S.FAILED, _S.CANCELLED}),
    _S.DONE: frozenset(),
    _S.FAILED: frozenset(),
    _S.CANCELLED: frozenset(),
}
