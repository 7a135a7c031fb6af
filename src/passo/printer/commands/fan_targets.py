"""SET_TEMPERATURE_FAN_TARGET: the targets of fans that cool the place of a sensor."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.part_names import found_name
from passo.errors import CommandError
from passo.gcode.registry import Subject, When, command
from passo.printer.commands.klipper_commands import number

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.gcode.command import Command
    from passo.printer.wait_requests import Reply

_MAX_C = 1200.0


class FanTargets:
    """The targets of the fans with a thermostat of one job: `targets_c` in °C, `powers` with the
    minimum and the maximum power of each."""

    def __init__(self, machine: MachineConfig) -> None:
        fans = {name: fan for name, fan in machine.fans.items() if fan.thermostat}
        kept = {name: fan.thermostat for name, fan in fans.items() if fan.thermostat}
        self.targets_c = {name: one.target_c for name, one in kept.items()}
        self.powers = {name: (one.min_power, fans[name].max_power) for name, one in kept.items()}

    @command(
        "SET_TEMPERATURE_FAN_TARGET",
        Subject.OUTPUTS,
        When.PLANNED,
        "TEMPERATURE_FAN TARGET(°C) MIN_SPEED(0-1) MAX_SPEED(0-1)",
        "Sets the temperature below which a fan keeps its sensor, at once; without TARGET the fan"
        " is off. The speeds limit its power until a restart.",
        bare=None,
        lacks="The machine file has no fan with a thermostat.",
    )
    def _set(self, command: Command, _: Reply) -> None:
        words = command.pairs()
        written = words.get("TEMPERATURE_FAN", words.get("temperature_fan", ""))
        name = found_name(self.targets_c, written)
        if name is None:
            limit = ", ".join(self.targets_c) or "none on this machine"
            raise CommandError.of(
                "command.value", axis="TEMPERATURE_FAN", value=written or "missing", limit=limit
            )
        low, high = self.powers[name]
        low, high = number(words, "MIN_SPEED", low), number(words, "MAX_SPEED", high)
        target = number(words, "TARGET", 0.0)
        if not 0 <= low <= high <= 1:
            value = f"{low:g} to {high:g}"
            raise CommandError.of("command.value", axis="speed", value=value, limit="0 to 1")
        if not 0 <= target <= _MAX_C:
            value = f"{target:g}"
            raise CommandError.of("command.value", axis="TARGET", value=value, limit="0 to 1200")
        self.powers[name], self.targets_c[name] = (low, high), target
