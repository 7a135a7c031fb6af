"""How commands reach moves that are planned already."""

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
        """Whether settings from there change what is planned, too, not only what follows."""
        ...

    def replan(self) -> None:
        """Plans again, by the limits of now, what the board does not have yet."""

    def scale_flow(self, extruder: int, factor: float) -> None:
        """Scales the filament of what the board does not have yet, and of all that follows."""

    def record_at_once(self, output: int, value: int) -> float:
        """Sets an output as early as possible; returns the clock at which that acts."""
        ...


class PlanAhead:
    """The plan of a job without consoles: a file is read in order, and nothing changes later."""

    def __init__(self, job: _core.Job) -> None:
        self._job = job

    def live(self, reply: Reply) -> bool:
        """Never."""
        del reply
        return False

    def replan(self) -> None:
        """Nothing to do: settings act on what follows."""

    def scale_flow(self, extruder: int, factor: float) -> None:
        """Scales what follows."""
        self._job.set_flow(extruder, factor)

    def record_at_once(self, output: int, value: int) -> float:
        """Sets the output after the moves so far: no user waits for it."""
        self._job.record(output, value)
        return inf


class LivePlan:
    """The plan of a printer with consoles. `during_print`: whether a reply belongs to a console
    during a print."""

    def __init__(self, drive: MotionQueue, during_print: Callable[[Reply], bool]) -> None:
        self._drive, self._during_print = drive, during_print

    def live(self, reply: Reply) -> bool:
        """During a print, for consoles."""
        return self._during_print(reply)

    def replan(self) -> None:
        """As `Drive.replan`."""
        self._drive.replan()

    def scale_flow(self, extruder: int, factor: float) -> None:
        """As `Drive.scale_flow`."""
        self._drive.scale_flow(extruder, factor)

    def record_at_once(self, output: int, value: int) -> float:
        """As `Drive.record_at_once`."""
        return self._drive.record_at_once(output, value)
