"""Pauses the print for an event at the printer, such as the end of the filament."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from passo.job.live.job_state import JobState

if TYPE_CHECKING:
    from passo.job.live.host_pause import HostPause
    from passo.job.live.runner import Runner
    from passo.printer.background_gcode import BackgroundGcode
    from passo.printer.control import Control

_log = logging.getLogger(__name__)

_PAUSE = "PAUSE"


class PrintPause:
    """Pauses the print of one printer, from a file or from a host, and asks the user to continue.
    If the machine file has a macro PAUSE, it pauses the print of a file and parks the nozzle."""

    def __init__(
        self,
        control: Control,
        runner: Runner,
        host_pause: HostPause,
        background: BackgroundGcode,
    ) -> None:
        self._control, self._runner = control, runner
        self._host_pause, self._background = host_pause, background

    @property
    def prints(self) -> bool:
        """Whether a file is being printed, or a host seems to print."""
        return self._runner.state is JobState.PRINTING or self._host_pause.prints

    async def pause(
        self, reason: str, action: str, words: Mapping[str, float] = MappingProxyType({})
    ) -> None:
        """Brakes at once, parks (`words` are those of M600), and shows the reason and the next
        action to the user. Returns when the file is paused; the pause itself continues."""
        control, runner = self._control, self._runner
        control.state.announce(_log, logging.WARNING, reason)
        if not runner.active:
            text = f"{reason}. {action}, then continue with M108"
            self._host_pause.interrupt(text, words, needed=lambda: True)
            return
        if control.rig.macros.calls(_PAUSE):
            await self._background.run("pause by an event", _PAUSE)
        if runner.state.prints:  # no macro, or one that has failed
            runner.pause(words)
        if runner.state is JobState.PAUSED:
            control.prompts.ask(f"{reason}. {action}, then continue with M24", awaited=False)
