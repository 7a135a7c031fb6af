"""Suspends the job of a printer, so that other moves are possible, and resumes it."""

from __future__ import annotations

from passo.motion.offsets import Offsets
from passo.printer.laser import Laser
from passo.printer.live_rig import LiveRig


class Suspension:
    """The suspension of one printer's job, and the filament that the job itself has moved."""

    def __init__(self, rig: LiveRig, offsets: Offsets, laser: Laser) -> None:
        self._rig, self._offsets, self._laser = rig, offsets, laser
        self.reset()

    def reset(self) -> None:
        """Call this after the boards have restarted, with an empty plan."""
        self._tool = 0  # of the job when it was suspended
        self._between_mm = 0.0  # filament moved while jobs were suspended
        self._stopped_mm: float | None = None  # `filament_mm` when the job was suspended

    def suspend(self, *, hand_over_macro: bool = False) -> None:
        """Brakes to a stop on the path and suspends the rest of the job. With `hand_over_macro`,
        the rest of the file's macro runs during the pause."""
        rig = self._rig
        rig.queue.hold()
        rig.job.stops.suspend(hand_over_macro)
        self._offsets.suspend()
        self._tool = rig.job.tool
        self._stopped_mm = self.filament_mm()
        rig.commands.follow_tool()

    def take_tool(self) -> None:
        """Selects the tool of the suspended job again, if another one was selected in the
        meantime."""
        rig = self._rig
        rig.job.tools.use(self._tool)
        rig.job.bed.follow_tool()
        rig.commands.tool_changed(self._tool)

    def resume(self) -> None:
        """Resumes the suspended job. The machine must be at its stop position again."""
        rig = self._rig
        rig.queue.before_moves()
        if rig.job.stops.suspended:
            self._offsets.resume()
        self._end()
        rig.job.stops.resume()
        rig.commands.follow_tool()
        rig.queue.after_moves()
        self._laser.end_blanking()

    def filament_mm(self) -> float:
        """The planned filament of all extruders so far, mm, without moves during the suspension of
        a job."""
        if not self._rig.job.stops.suspended:
            self._end()
        if self._stopped_mm is not None:
            return self._stopped_mm
        return self._pushed_mm() - self._between_mm

    def _pushed_mm(self) -> float:
        return sum(self._rig.job.results.statistics()["filament_mm"])

    def _end(self) -> None:
        """Call this when the suspended job has resumed or was discarded."""
        if self._stopped_mm is not None:
            self._between_mm = self._pushed_mm() - self._stopped_mm
            self._stopped_mm = None
