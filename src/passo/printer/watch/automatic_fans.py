"""Fans that follow the temperature of a heater, or motors."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.config.electronics import Fan
    from passo.printer.commands.motors import Motors
    from passo.printer.live_rig import LiveRig
    from passo.printer.state import State

_STAYS_C = 2.0  # hysteresis: a fan is switched off this far below its threshold


class AutomaticFans:
    """The fans of one printer that follow heaters or motors. A fan runs at its `max_power` while
    its heater is above the threshold or has failed (the temperature is then unknown), and while any
    of its motors is on, and for some time afterwards. A halted board has switched all its outputs
    off."""

    def __init__(self, rig: LiveRig, state: State, motors: Motors) -> None:
        self._rig, self._state, self._motors = rig, state, motors
        fans = rig.machine.fans
        self._fans = {n: f for n, f in fans.items() if not f.commanded and f.max_power > 0}
        self._motors_s: dict[str, float] = {}  # host time at which a fan's motors were last on

    def time_passed(self) -> None:
        """Checks the heaters and motors."""
        if self._state.halted:
            return
        commands = self._rig.commands
        for name, fan in self._fans.items():
            was_on = commands.outputs.fans.get(name, 0.0) > 0
            on = self._warm(fan, was_on) or self._works(name, fan)
            if on != was_on:
                commands.outputs.set_fan(name, fan.max_power if on else 0.0, at_once=True)

    def _warm(self, fan: Fan, was_on: bool) -> bool:
        if fan.follows is None:
            return False
        heater = self._rig.connection.heaters[fan.follows]
        threshold = fan.above_c - _STAYS_C if was_on else fan.above_c
        return heater.celsius > threshold or heater.fault is not None

    def _works(self, name: str, fan: Fan) -> bool:
        now_s = asyncio.get_running_loop().time()
        if any(map(self._motors.live, fan.follows_motors)):
            self._motors_s[name] = now_s
        return name in self._motors_s and now_s <= self._motors_s[name] + fan.stays_on_s
