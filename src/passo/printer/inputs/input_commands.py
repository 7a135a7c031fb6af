"""M43: reports and watches the inputs of a printer."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.gcode.command import Command
from passo.gcode.parameters import number
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.wait_requests import Reply

if TYPE_CHECKING:
    from passo.printer.inputs.inputs import Inputs
    from passo.printer.live_rig import LiveRig
    from passo.printer.state import State


class InputCommands:
    """M43 of one printer."""

    def __init__(self, rig: LiveRig, state: State, inputs: Inputs) -> None:
        self._pins, self._state, self._inputs = rig.machine.input_pins, state, inputs
        self._watches = False
        inputs.watchers.append(self._changed)

    @command(
        "M43",
        Subject.MOTORS,
        When.IMMEDIATE,
        "Reports the inputs of filament sensors and buttons; W1 also reports each change from now"
        " on, W0 ends that. M119 reports endstops.",
        number("W", "1: reports each change, 0: no more"),
        kind=Kind.QUIET,
        lacks="The machine file has no filament sensor and no button.",
    )
    def _report(self, command: Command, reply: Reply) -> None:
        if command.has("W"):
            self._watches = command.value("W") != 0
        active = self._inputs.active
        for name, pin in self._pins.items():
            reply.say(f"echo:{name} on pin {pin}: {_spoken(active.get(name))}")

    def _changed(self, name: str, active: bool) -> None:
        if self._watches:
            self._state.tell(f"echo:{name} on pin {self._pins[name]}: {_spoken(active)}")


def _spoken(active: bool | None) -> str:
    return "not reported yet" if active is None else "active" if active else "not active"
