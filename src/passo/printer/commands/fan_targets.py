"""SET_TEMPERATURE_FAN_TARGET: the targets of fans that cool the place of a sensor."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.part_names import found_name
from passo.errors import CommandError
from passo.gcode.parameters import number, text
from passo.gcode.registry import Subject, When, command

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.gcode.command import Command
    from passo.printer.wait_requests import Reply

_MAX_C = 1200.0
_COOLER = "cooler"
_LACKS = "The machine file has no fan with a thermostat."


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
        "Sets the temperature below which a fan keeps its sensor, at once; without TARGET the fan"
        " is off. The speeds limit its power until a restart.",
        text("TEMPERATURE_FAN", "the name of the fan"),
        number("TARGET", "the temperature; 0: off", "°C", 0, _MAX_C, default=0),
        number("MIN_SPEED", "the least power", low=0, high=1),
        number("MAX_SPEED", "the largest power", low=0, high=1),
        lacks=_LACKS,
    )
    def _set(self, command: Command, _: Reply) -> None:
        self._set_target(command, command.string("TEMPERATURE_FAN"))

    @command(
        "M142",
        Subject.OUTPUTS,
        When.PLANNED,
        "Sets the temperature below which the cooler keeps its sensor; without S it is off. The"
        " cooler is the fan of the name `cooler`, or the first one with a thermostat.",
        number("S", "the temperature; 0: off", "°C", 0, _MAX_C, default=0),
        lacks=_LACKS,
    )
    def _set_cooler(self, command: Command, reply: Reply) -> None:
        name = found_name(self.targets_c, _COOLER) or next(iter(self.targets_c), None)
        if name is None:
            reply.no_part(command.code, _LACKS)
        else:
            self.targets_c[name] = command.value("S")

    def _set_target(self, command: Command, written: str) -> None:
        name = found_name(self.targets_c, written)
        if name is None:
            limit = ", ".join(self.targets_c) or "none on this machine"
            raise CommandError.of(
                "command.value", axis="TEMPERATURE_FAN", value=written or "missing", limit=limit
            )
        low, high = self.powers[name]
        low, high = command.value("MIN_SPEED", low), command.value("MAX_SPEED", high)
        if low > high:
            value = f"{low:g} to {high:g}"
            raise CommandError.of("command.value", axis="speed", value=value, limit="0 to 1")
        self.powers[name], self.targets_c[name] = (low, high), command.value("TARGET")
