"""Fans that follow the temperature of a heater or a sensor, motors, or targets of heaters."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.config.electronics import Fan, Thermostat
    from passo.printer.commands.motors import Motors
    from passo.printer.live_rig import LiveRig
    from passo.printer.state import State
    from passo.printer.watch.sensors import SensorWatch

_STAYS_C = 2.0  # hysteresis: a fan is switched off this far below its threshold
_PERIOD_S = 0.25  # between two updates of a thermostat
_FULL_GAIN = 255  # gains are in fractions of this
_SMALL = 0.004  # changes of power that are not sent


class _Pid:
    """The controller of a fan with a thermostat: the more the sensor is above the target, the more
    power. The sum of errors stays within what the power can use."""

    def __init__(self, kp: float, ki: float, kd: float) -> None:
        self._kp, self._ki, self._kd = (gain / _FULL_GAIN for gain in (kp, ki, kd))
        self._sum = 0.0
        self._before: float | None = None

    def power(self, above_c: float, dt_s: float, most: float) -> float:
        """The power for a sensor that is so far above its target, at most `most`."""
        slope = 0.0 if self._before is None or dt_s <= 0 else (above_c - self._before) / dt_s
        self._before = above_c
        if self._ki:
            self._sum = min(max(self._sum + above_c * dt_s, 0.0), most / self._ki)
        power = self._kp * above_c + self._ki * self._sum + self._kd * slope
        return min(max(power, 0.0), most)


class AutomaticFans:
    """The fans of one printer that follow something. A fan runs at its `max_power` while its heater
    is above the threshold or has failed (the temperature is then unknown), and while any of its
    motors is on or any of its heaters has a target, and for some time afterwards. One with a
    thermostat cools a sensor. A halted board has switched all its outputs off."""

    def __init__(self, rig: LiveRig, state: State, motors: Motors, sensors: SensorWatch) -> None:
        self._rig, self._state, self._motors, self._sensors = rig, state, motors, sensors
        fans = rig.machine.fans
        self._fans = {n: f for n, f in fans.items() if not f.commanded and f.max_power > 0}
        self._works_s: dict[str, float] = {}  # host time at which a fan was last needed
        self._pids = {
            name: _Pid(kept.kp, kept.ki or 0.0, kept.kd or 0.0)
            for name, fan in fans.items()
            if (kept := fan.thermostat) is not None and kept.kp is not None
        }
        self._updated_s: dict[str, float] = {}

    def time_passed(self) -> None:
        """Checks what the fans follow."""
        if self._state.halted:
            return
        outputs = self._rig.commands.outputs
        for name, fan in self._fans.items():
            now = outputs.fans.get(name, 0.0)
            power = self._power(name, fan, now)
            if abs(power - now) > _SMALL or (power > 0) != (now > 0):
                outputs.set_fan(name, power, at_once=True)

    def _power(self, name: str, fan: Fan, now: float) -> float:
        if fan.thermostat is not None:
            return self._cools(name, fan.thermostat, now)
        if self._warm(fan, now > 0):
            return fan.max_power
        return self._works(name, fan)

    def _warm(self, fan: Fan, was_on: bool) -> bool:
        heaters = [self._rig.connection.heaters[name] for name in fan.warmed_by]
        threshold = fan.above_c - _STAYS_C if was_on else fan.above_c
        return any(one.celsius > threshold or one.fault is not None for one in heaters)

    def _works(self, name: str, fan: Fan) -> float:
        """The power of a fan that follows motors, or targets of heaters."""
        now_s, heaters = asyncio.get_running_loop().time(), self._rig.connection.heaters
        on = any(map(self._motors.live, fan.follows_motors))
        if on or any(heaters[one].target > 0 for one in fan.follows_targets):
            self._works_s[name] = now_s
            return fan.max_power
        if name in self._works_s and now_s <= self._works_s[name] + fan.stays_on_s:
            return fan.max_power if fan.idle_power is None else fan.idle_power
        return 0.0

    def _cools(self, name: str, kept: Thermostat, now: float) -> float:
        """The power of a fan with a thermostat."""
        targets = self._rig.commands.fan_targets
        target_c, (least, most) = targets.targets_c[name], targets.powers[name]
        celsius = self._sensors.celsius(kept.sensor)
        if target_c <= 0:
            return 0.0
        if celsius is None:
            return most
        above_c, now_s = celsius - target_c, asyncio.get_running_loop().time()
        pid = self._pids.get(name)
        if pid is None:
            on = above_c >= (-kept.hysteresis_c if now > 0 else kept.hysteresis_c)
            return most if on else 0.0
        dt_s = now_s - self._updated_s.setdefault(name, now_s)
        if 0 < dt_s < _PERIOD_S:
            return now
        self._updated_s[name] = now_s
        return max(least, pid.power(above_c, dt_s, most))
