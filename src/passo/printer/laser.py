"""Switches the laser off at standstill."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager

from passo.printer.live_rig import LiveRig
from passo.printer.state import State


class Laser:
    """Switches the laser of one printer off, permanently or during a standstill."""

    def __init__(self, rig: LiveRig, state: State) -> None:
        self._rig, self._state = rig, state
        self._blanked = False  # temporarily off

    def reset(self) -> None:
        """Call this after the boards have been replaced, with all outputs off."""
        self._blanked = False

    def off(self) -> None:
        """Switches the laser off when the moves so far are done, until a command switches it on
        again."""
        if self._rig.machine.laser and not self._state.halted:
            self._rig.queue.before_moves()
            self._rig.commands.outputs.laser_off()
            self._rig.queue.after_moves()

    @contextmanager
    def blanked(self) -> Generator[None]:
        """Blanks the laser within the block, from the end of the moves so far on, and restores it
        afterwards unless it was switched off permanently in the meantime."""
        if self._rig.commands.outputs.laser_stays_on and not self._blanked:
            self._blank(blanked=True)
        try:
            yield
        finally:
            self.end_blanking()

    def end_blanking(self) -> None:
        """Ends the blanking. A suspended job stays blanked."""
        if self._blanked and not (self._state.halted or self._rig.job.stops.suspended):
            self._blank(blanked=False)

    def _blank(self, *, blanked: bool) -> None:
        self._blanked = blanked
        self._rig.queue.before_moves()
        self._rig.commands.outputs.blank_laser(blanked=blanked)
        self._rig.queue.after_moves()
