"""Changes of moves that are planned already, for commands."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable

    from passo import _core
    from passo.motion.motion_queue import MotionQueue
    from passo.printer.wait_requests import Reply


class Plan(Protocol):
    """The planned moves of a job that commands may change."""

    def live(self, reply: Reply) -> bool:
        """Whether settings from the source `reply` also change planned moves, not only later
        ones."""
        ...

    def replan(self) -> None:
        """Replans the moves that the board does not have yet, by the current limits."""

    def scale_flow(self, extruder: int, factor: float) -> None:
        """Scales the filament of the moves that the board does not have yet, and of all later
        ones."""

    def record_at_once(self, output: int, value: int) -> float:
        """Sets an output as early as possible; returns the clock at which it changes."""
        ...


class PlanAhead:
    """The plan of a job without consoles: a file is read in order, and planned moves never
    change."""

    def __init__(self, job: _core.Job) -> None:
        self._job = job

    def live(self, reply: Reply) -> bool:
        """Never live."""
        del reply
        return False

    def replan(self) -> None:
        """Does nothing: settings act only on later lines."""

    def scale_flow(self, extruder: int, factor: float) -> None:
        """Scales later moves."""
        self._job.filament.set_flow(extruder, factor)

    def record_at_once(self, output: int, value: int) -> float:
        """Sets the output after the moves so far."""
        self._job.outputs.record(output, value)
        return inf


class LivePlan:
    """The plan of a printer with consoles. `during_print(reply)` is True for a console during a
    print."""

    def __init__(self, drive: MotionQueue, during_print: Callable[[Reply], bool]) -> None:
        self._drive, self._during_print = drive, during_print

    def live(self, reply: Reply) -> bool:
        """Live for consoles during a print."""
        return self._during_print(reply)

    def replan(self) -> None:
        """Like `MotionQueue.replan`."""
        self._drive.replan()

    def scale_flow(self, extruder: int, factor: float) -> None:
        """Like `MotionQueue.scale_flow`."""
        self._drive.scale_flow(extruder, factor)

    def record_at_once(self, output: int, value: int) -> float:
        """Like `MotionQueue.record_at_once`."""
        return self._drive.record_at_once(output, value)
