"""The laser of a printer at standstill."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager

from passo.printer.live_rig import LiveRig
from passo.printer.state import State


class Laser:
    """Switches the laser of one printer off, permanently or during a standstill."""

    def __init__(self, rig: LiveRig, state: State) -> None:
        self._rig, self._state = rig, state
        self._dark = False  # temporarily: it will be switched on again

    def begin(self) -> None:
        """The boards have been replaced: all outputs are off."""
        self._dark = False

    def off(self) -> None:
        """Switches it off when the moves so far are done, until it is switched on again."""
        if self._rig.machine.laser and not self._state.halted:
            self._rig.queue.before_moves()
            self._rig.commands.outputs.laser_off()
            self._rig.queue.after_moves()

    @contextmanager
    def dark(self) -> Generator[None]:
        """Switches it off when the moves so far are done, and restores it at the end of the block,
        unless it was switched off permanently meanwhile."""
        if self._rig.commands.outputs.lit and not self._dark:
            self._shade(dark=True)
        try:
            yield
        finally:
            self.light()

    def light(self) -> None:
        """Ends the blanking; a suspended job keeps it."""
        if self._dark and not (self._state.halted or self._rig.job.suspended):
            self._shade(dark=False)

    def _shade(self, *, dark: bool) -> None:
        self._dark = dark
        self._rig.queue.before_moves()
        self._rig.commands.outputs.shade(dark=dark)
        self._rig.queue.after_moves()
