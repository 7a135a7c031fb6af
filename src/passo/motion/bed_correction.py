"""The correction of the bed that is in force on one printer."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from passo.levelling.correction import apply

if TYPE_CHECKING:
    from passo.levelling.correction import Correction
    from passo.motion.rig import Rig


class BedCorrection:
    """The height of the bed that is added to Z. Homing and probing switch it off while they run. It
    survives a restart of the boards. No motor moves when it changes, but Z of the plan does.

    `correction` is the one that was last measured, set or loaded, also while it is not `on`. Only
    while the machine is idle.
    """

    def __init__(self, rig: Rig, halted: Callable[[], bool]) -> None:
        self._rig, self._halted = rig, halted
        self._suspended = False
        self.correction: Correction | None = None
        self.on = False

    def begin(self) -> None:
        """The boards have been replaced, and the plan with them."""
        self._suspended = False
        self._apply()

    def use(self, correction: Correction | None, *, on: bool) -> None:
        """Sets the correction, and switches it on or off; without one it is off. Raises
        CommandError for one that fades too fast; nothing changes then."""
        before = self.correction, self.on
        self.correction, self.on = correction, on and correction is not None
        try:
            self._apply()
        except BaseException:
            self.correction, self.on = before
            raise

    def suspend(self) -> None:
        """Positions are those of the machine itself until `resume`."""
        self._suspended = True
        self._apply()

    def resume(self) -> None:
        """The correction is in force again, if it is on."""
        self._suspended = False
        if not self._halted():
            self._apply()

    @contextmanager
    def suspended(self) -> Generator[None]:
        """Within the block, positions are those of the machine without correction."""
        if self._suspended:
            yield
            return
        self.suspend()
        try:
            yield
        finally:
            self.resume()

    def expected(self, x: float, y: float) -> float:
        """The height of the bed at a place, mm, if it is known; else 0."""
        return self.correction.plain(x, y) if self.correction else 0.0

    def _apply(self) -> None:
        axes = self._rig.machine.axes
        area = axes["x"].min_mm, axes["y"].min_mm, axes["x"].max_mm, axes["y"].max_mm
        correction = self.correction if self.on and not self._suspended else None
        apply(correction, area, self._rig.job)
