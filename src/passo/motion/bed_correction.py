"""The active bed correction of one printer."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from passo.levelling.correction import apply

if TYPE_CHECKING:
    from passo.levelling.correction import Correction, HeightMapTarget
    from passo.motion.rig import Rig


class BedCorrection:
    """The height of the bed that is added to Z. Homing and probing switch it off while they run. It
    survives a restart of the boards. No motor moves when it changes, but Z of the plan does.

    `correction` is the last one that was measured, set or loaded, even while it is not `on`. Call
    the methods only while the machine is idle.
    """

    def __init__(self, rig: Rig, halted: Callable[[], bool]) -> None:
        self._rig, self._halted = rig, halted
        self._suspended = False
        self.correction: Correction | None = None
        self.on = False

    def reset(self) -> None:
        """Call this after the boards and the plan have been replaced."""
        self._suspended = False
        self._apply()

    def use(self, correction: Correction | None, *, on: bool) -> None:
        """Sets the correction, and switches it on or off; None switches it off. Raises CommandError
        for a correction that fades too fast, without any change."""
        before = self.correction, self.on
        self.correction, self.on = correction, on and correction is not None
        try:
            self._apply()
        except BaseException:
            self.correction, self.on = before
            raise

    def suspend(self) -> None:
        """Switches the correction off until `resume`: positions are machine positions."""
        self._suspended = True
        self._apply()

    def resume(self) -> None:
        """Ends `suspend`: the correction applies again if it is on."""
        self._suspended = False
        if not self._halted():
            self._apply()

    @contextmanager
    def suspended(self) -> Generator[None]:
        """Suspends the correction within the block."""
        if self._suspended:
            yield
            return
        self.suspend()
        try:
            yield
        finally:
            self.resume()

    def expected(self, x: float, y: float) -> float:
        """The height of the bed at X, Y by the last measurement, mm; 0 without one."""
        return self.correction.plain(x, y) if self.correction else 0.0

    def apply_to(self, bed: HeightMapTarget) -> None:
        """Gives the bed of another job of the same machine, with no move queued, the correction
        that is in force."""
        axes = self._rig.machine.axes
        area = axes["x"].min_mm, axes["y"].min_mm, axes["x"].max_mm, axes["y"].max_mm
        correction = self.correction if self.on and not self._suspended else None
        apply(correction, area, bed)

    def _apply(self) -> None:
        self.apply_to(self._rig.job.bed)
