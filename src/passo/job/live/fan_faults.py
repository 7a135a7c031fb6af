"""Pauses the print when a fan turns too slowly."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.job.live.print_pause import PrintPause
    from passo.printer.background_gcode import BackgroundGcode
    from passo.printer.state import State
    from passo.printer.watch.tachometers import FanFault, Tachometers

_log = logging.getLogger(__name__)


class FanFaultPause:
    """Pauses the print of one printer for each fault of a fan that asks for it. Without a print,
    the fault is only reported."""

    def __init__(
        self,
        state: State,
        tachometers: Tachometers,
        pause: PrintPause,
        background: BackgroundGcode,
    ) -> None:
        self._state, self._pause, self._background = state, pause, background
        tachometers.listeners.append(self._failed)

    def _failed(self, fault: FanFault) -> None:
        problem = fault.problem
        if self._pause.prints:
            sentence = problem.sentence[:1].upper() + problem.sentence[1:]
            self._background.spawn(self._pause.pause(sentence, problem.entry.action))
        else:
            self._state.announce(_log, logging.WARNING, str(problem), problem)
