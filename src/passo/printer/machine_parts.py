"""The parts of one machine by subject, for what moves and heats it by itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.printer.settings import Settings
    from passo.printer.setup.heat import Heat
    from passo.printer.setup.inputs import InputParts
    from passo.printer.setup.levelling import Levelling
    from passo.printer.setup.motion import Motion
    from passo.printer.setup.outputs import Outputs
    from passo.printer.suspension import Suspension
    from passo.printer.watch.late_commands import LateCommandWatch
    from passo.printer.watch.sensors import SensorWatch
    from passo.printer.watch.tachometers import Tachometers


@dataclass(frozen=True, slots=True)
class MachineParts:
    """The parts of one machine: prints pause and resume with them, and the status shows them.
    `sensors` are those without a heater, `tachometers` those of fans, `suspension` suspends the
    job, `settings` has all settings as commands, and `lateness` counts commands that the boards
    received late."""

    outputs: Outputs
    motion: Motion
    heat: Heat
    levelling: Levelling
    inputs: InputParts
    sensors: SensorWatch
    tachometers: Tachometers
    suspension: Suspension
    settings: Settings
    lateness: LateCommandWatch
