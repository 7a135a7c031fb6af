"""Builds the parts that use inputs: filament sensors and buttons."""

from __future__ import annotations

from dataclasses import dataclass

from passo.printer.inputs.buttons import Buttons
from passo.printer.inputs.filament_sensors import FilamentSensors
from passo.printer.inputs.filament_widths import FilamentWidths
from passo.printer.inputs.input_commands import InputCommands
from passo.printer.inputs.inputs import Inputs
from passo.printer.live_rig import LiveRig
from passo.printer.state import State
from passo.printer.status import FilamentSensorStatus


@dataclass(frozen=True, slots=True)
class InputParts:
    """The inputs of one printer, and the parts that use them."""

    inputs: Inputs
    filament: FilamentSensors
    width: FilamentWidths | None
    buttons: Buttons
    handlers: list[object]  # the parts that handle commands

    def time_passed(self) -> None:
        """Call this as time passes."""
        self.inputs.time_passed()
        self.filament.time_passed()
        if self.width is not None:
            self.width.time_passed()

    def filament_status(self) -> dict[str, FilamentSensorStatus]:
        """The filament sensors for the status of the printer."""
        found = self.filament.status()
        if self.width is not None:
            found |= self.width.status(found)
        return found

    def reset(self) -> None:
        """Call this after the boards have restarted: no filament has been pushed yet."""
        self.filament.reset()
        if self.width is not None:
            self.width.reset()


def build_inputs(rig: LiveRig, state: State) -> InputParts:
    """Builds the inputs of a connected machine."""
    inputs = Inputs(rig)
    filament, buttons = FilamentSensors(rig, inputs), Buttons(rig.machine, inputs)
    handlers: list[object] = [filament] if rig.machine.filament_sensors else []
    if rig.machine.input_pins:
        handlers.append(InputCommands(rig, state, inputs))
    measuring = [s for s in filament.sensors.values() if s.config.width is not None]
    width = FilamentWidths(rig, state, inputs, filament, measuring[0]) if measuring else None
    handlers += [width] if width else []
    return InputParts(inputs, filament, width, buttons, handlers)
