"""The last minutes of each heater, for the report of a halt."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from passo.motion.rig import Rig

EVERY_S = 1.0
KEPT_S = 300.0


class HeaterSample(NamedTuple):
    """A heater at one moment: °C or None while its sensor has not reported, target in °C, power as
    a fraction of full power, and whether a protection has switched it off."""

    celsius: float | None
    target_c: float
    power: float
    failed: bool


class HeaterHistory:
    """Samples of all heaters since the last restart (M999), one every `EVERY_S` of print time, kept
    for `KEPT_S`."""

    def __init__(self, rig: Rig) -> None:
        self._rig = rig
        self._samples: deque[tuple[float, dict[str, HeaterSample]]] = deque(
            maxlen=int(KEPT_S / EVERY_S)
        )

    def time_passed(self) -> None:
        """Takes a sample if one is due."""
        now_s = self._rig.queue.now_s
        if self._samples and now_s < self._samples[-1][0]:
            self._samples.clear()  # print time restarts
        if not self._samples or now_s >= self._samples[-1][0] + EVERY_S:
            self._samples.append((now_s, self.now()))

    def now(self) -> dict[str, HeaterSample]:
        """The current state of the heaters, from the last reports."""
        return {
            name: HeaterSample(
                heater.celsius if heater.connected else None,
                heater.target,
                heater.power,
                heater.fault is not None,
            )
            for name, heater in self._rig.connection.heaters.items()
        }

    def samples(self) -> list[tuple[float, dict[str, HeaterSample]]]:
        """(print time in seconds, sample of each heater), oldest first."""
        return list(self._samples)
