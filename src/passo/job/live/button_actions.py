"""What the buttons of a printer do."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import TYPE_CHECKING

from passo.errors import MachineError, PassoError
from passo.job.live.job_state import JobState

if TYPE_CHECKING:
    from passo.job.live.print_pause import PrintPause
    from passo.job.live.runner import Runner
    from passo.printer.background_gcode import BackgroundGcode
    from passo.printer.control import Control
    from passo.printer.inputs.buttons import Buttons

_log = logging.getLogger(__name__)


class ButtonActions:
    """Carries out the actions and the G-code of the buttons of one printer."""

    def __init__(
        self,
        control: Control,
        buttons: Buttons,
        runner: Runner,
        pause: PrintPause,
        background: BackgroundGcode,
    ) -> None:
        self._control, self._runner = control, runner
        self._print_pause, self._background = pause, background
        self._actions: dict[str, Callable[[str], None]] = {
            "none": lambda _: None,
            "pause": self._pause,
            "resume": lambda _: self._resume(),
            "cancel": lambda _: runner.cancel(),
            "halt": self._halt,
        }
        buttons.listeners.append(self._changed)

    def _changed(self, name: str, pressed: bool) -> None:
        config = self._control.machine.buttons[name]
        key = "press_gcode" if pressed else "release_gcode"
        _log.info("Button %s %s", name, "pressed" if pressed else "released")
        if pressed:
            try:
                self._actions[config.action](name)
            except PassoError as error:
                self._control.state.announce(_log, logging.WARNING, f"Button {name}: {error}")
        text: str = getattr(config, key)
        if text:
            self._background.start(f"buttons.{name}.{key}", text)

    def _pause(self, name: str) -> None:
        if self._print_pause.prints:
            work = self._print_pause.pause(
                f"Button {name} has paused the print", "Check the printer"
            )
            self._background.spawn(work)

    def _resume(self) -> None:
        if self._runner.state is JobState.PAUSED:
            self._runner.start()

    def _halt(self, name: str) -> None:
        pressed = MachineError.of("machine.stop-button", value=name)
        self._control.stops.halt(pressed, pressed.problems[0].sentence)
