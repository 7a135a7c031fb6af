"""Commands that set parts which Passo does not drive, for the macros that read them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.part_names import found_name
from passo.gcode.registry import in_program
from passo.printer.skipped_commands import SkippedCommand
from passo.printer.stand_ins import FILAMENT_SENSORS
from passo.printer.status import FilamentSensorStatus

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.gcode.command import Command
    from passo.printer.skipped_commands import SkippedCommands
    from passo.printer.stand_ins import StandIns
    from passo.printer.wait_requests import Reply


class StandInCommands:
    """The commands of one job that set parts which Passo does not drive. Each is counted in
    `omitted`. `filament_sensors` are the sensors of the machine in a program that is only
    planned: whether they are enabled."""

    def __init__(
        self, machine: MachineConfig, stand_ins: StandIns, omitted: SkippedCommands
    ) -> None:
        self._stand_ins, self._omitted = stand_ins, omitted
        self._sensors = machine.filament_sensors
        self._enabled = {name: part.enabled for name, part in self._sensors.items()}

    @property
    def filament_sensors(self) -> dict[str, FilamentSensorStatus]:
        """The sensors of the machine, which detect filament."""
        return {
            name: FilamentSensorStatus(True, self._enabled[name], moves=part.kind == "motion")
            for name, part in self._sensors.items()
        }

    @in_program("SET_FILAMENT_SENSOR")
    def _filament(self, command: Command, _: Reply) -> None:
        on, wanted = command.value("ENABLE") != 0, command.string("SENSOR")
        own = found_name(self._sensors, wanted)
        if own is not None:
            self._enabled[own] = on
            return
        self._set(command, FILAMENT_SENSORS, wanted, "enabled", on)

    def _set(
        self, command: Command, kinds: tuple[str, ...], name: str, key: str, value: float | bool
    ) -> None:
        state = self._stand_ins.named(kinds, name)
        if state is not None:
            state[key] = value
        self._omitted.count(SkippedCommand.NOT_BUILT, command.code, command.line)
