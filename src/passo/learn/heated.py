"""Heats a simulated hotend for an experiment, with the controllers that prints use."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from passo import _core

Control: TypeAlias = _core.PidControl | _core.OnOffControl | _core.ModelControl
AMBIENT_C = 25.0
RISE_C, TIME_CONSTANT_S, SENSOR_LAG_S = 400.0, 160.0, 4.0  # of the hotend of the lessons
FAN_LOSS = 0.3
HOTEND = _core.HeatModel(RISE_C, TIME_CONSTANT_S, SENSOR_LAG_S, FAN_LOSS, AMBIENT_C)
_NO_PROTECTIONS = _core.ProtectionLimits(
    min_c=-50.0,
    max_c=1000.0,
    jump_c=0.0,
    watch_rise_c=0.0,
    watch_s=0.0,
    runaway_c=0.0,
    runaway_s=0.0,
    stuck_on_c=0.0,
    stuck_on_s=0.0,
    deviation=0.0,
    deviation_s=0.0,
)


@dataclass(frozen=True, slots=True)
class Heating:
    """Temperatures and powers, each at its time in s; power is a fraction of full power."""

    times_s: Sequence[float]
    celsius: Sequence[float]
    power: Sequence[float]

    @property
    def highest_c(self) -> float:
        """The highest temperature."""
        return max(self.celsius)

    def after(self, seconds: float) -> Heating:
        """What comes later than this."""
        first = next(i for i, time in enumerate(self.times_s) if time >= seconds)
        return Heating(self.times_s[first:], self.celsius[first:], self.power[first:])

    def settled_s(self, target_c: float, within_c: float) -> float:
        """The time from which the temperature stays within a band; the whole time if it never
        does."""
        outside = [
            time
            for time, celsius in zip(self.times_s, self.celsius, strict=True)
            if abs(celsius - target_c) > within_c
        ]
        return outside[-1] if outside else 0.0


def heated(
    control: Control,
    target_c: float,
    seconds: float,
    *,
    fan_from_s: float | None = None,
    every_s: float = 1.0,
) -> Heating:
    """Heats the hotend from the room's temperature, without protections; from `fan_from_s` on the
    fan blows at full speed."""
    body = _core.HeatRun(HOTEND, control, _core.Arrival(), 1.0, _NO_PROTECTIONS, HOTEND)
    body.heater.target = target_c
    times, celsius, power = [0.0], [AMBIENT_C], [0.0]
    while times[-1] < seconds:
        if fan_from_s is not None and times[-1] >= fan_from_s:
            body.set_fan(1.0)
        body.run(every_s)
        times.append(times[-1] + every_s)
        celsius.append(body.heater.celsius)
        power.append(body.heater.power)
    return Heating(times, celsius, power)
