"""Builds the parts that use inputs: filament sensors and buttons."""

from __future__ import annotations

from dataclasses import dataclass

from passo.printer.inputs.buttons import Buttons
from passo.printer.inputs.filament_sensors import FilamentSensors
from passo.printer.inputs.input_commands import InputCommands
from passo.printer.inputs.inputs import Inputs
from passo.printer.live_rig import LiveRig
from passo.printer.state import State


@dataclass(frozen=True, slots=True)
class InputParts:
    """The inputs of one printer, and the parts that use them."""

    inputs: Inputs
    filament: FilamentSensors
    buttons: Buttons
    handlers: list[object]  # the parts that handle commands

    def time_passed(self) -> None:
        """Call this as time passes."""
        self.inputs.time_passed()
        self.filament.time_passed()


def build_inputs(rig: LiveRig, state: State) -> InputParts:
    """Builds the inputs of a connected machine."""
    inputs = Inputs(rig)
    filament, buttons = FilamentSensors(rig, inputs), Buttons(rig.machine, inputs)
    handlers: list[object] = [filament] if rig.machine.filament_sensors else []
    if rig.machine.input_pins:
        handlers.append(InputCommands(rig, state, inputs))
    return InputParts(inputs, filament, buttons, handlers)
