"""The buttons and switches of a running printer that do something: their states."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from passo.config.inputs import button_input

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.printer.inputs.inputs import Inputs


class Buttons:
    """The buttons of one printer. `pressed` has those whose state is known; `listeners` are called
    with the name of a button and its new state. A button that is pressed at the start is not an
    event."""

    def __init__(self, machine: MachineConfig, inputs: Inputs) -> None:
        self.pressed: dict[str, bool] = {}
        self.listeners: list[Callable[[str, bool], None]] = []
        for name, config in machine.buttons.items():
            inputs.on_level(
                button_input(name),
                config.debounce_s,
                lambda level, first, name=name: self._changed(name, level, first=first),
            )

    def _changed(self, name: str, pressed: bool, *, first: bool) -> None:
        self.pressed[name] = pressed
        if not first:
            for listener in self.listeners:
                listener(name, pressed)
