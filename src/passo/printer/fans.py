"""Fans that follow the temperature of a heater."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.printer.printer import Printer

_STAYS_C = 2.0  # so much below its threshold a fan goes off again


class FollowingFans:
    """The fans of one printer that `follow` a heater: fully on, as far as `max_power` lets them,
    above its threshold, and while it has failed, for nobody knows then how hot it is. A halted
    board has all its outputs off."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        fans = printer.machine.fans
        self._fans = [
            (name, fan, fan.follows)
            for name, fan in fans.items()
            if fan.follows and fan.max_power > 0
        ]

    def time_passed(self) -> None:
        """Looks at the heaters."""
        if self._printer.halted:
            return
        commands = self._printer.commands
        for name, fan, follows in self._fans:
            heater = self._printer.connection.heaters[follows]
            was_on = commands.fans.get(name, 0.0) > 0
            threshold = fan.above_c - _STAYS_C if was_on else fan.above_c
            on = heater.celsius > threshold or heater.fault is not None
            if on != was_on:
                commands.set_output(name, fan.max_power if on else 0.0, at_once=True)
