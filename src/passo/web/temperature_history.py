"""Temperatures of the last day, which the server keeps for pages that are opened later."""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from passo.web.bridge import Bridge, Snapshot

_FINE_S, _FINE_FOR_S = 1, 15 * 60
_COARSE_S, _COARSE_FOR_S = 15, 24 * 3600


class Reading(NamedTuple):
    """A heater at one moment: temperature and target in °C, power as a fraction."""

    celsius: float | None
    target_c: float
    power: float


class Sample(NamedTuple):
    """All heaters, and the other temperature sensors in °C, at a host time in seconds."""

    host_s: float
    heaters: dict[str, Reading]
    sensors: dict[str, float | None]


class TemperatureHistory:
    """One sample per second for the last 15 minutes, and one every 15 s for the day before: about
    6600 samples at most."""

    def __init__(self) -> None:
        self._fine: deque[Sample] = deque()
        self._coarse: deque[Sample] = deque(maxlen=_COARSE_FOR_S // _COARSE_S)

    def add(self, snapshot: Snapshot, now_s: float) -> None:
        """Adds the temperatures of a snapshot as those of `now_s`, a monotonic host time in
        seconds."""
        self._fine.append(
            Sample(
                now_s,
                {
                    name: Reading(heater.current_c, heater.target_c, heater.power)
                    for name, heater in snapshot.status.heaters.items()
                },
                {
                    name: None if sensor.age_s else sensor.celsius
                    for name, sensor in snapshot.status.sensors.items()
                },
            )
        )
        while self._fine[0].host_s < now_s - _FINE_FOR_S:
            sample = self._fine.popleft()
            if not self._coarse or sample.host_s >= self._coarse[-1].host_s + _COARSE_S:
                self._coarse.append(sample)

    def since(self, host_s: float) -> list[Sample]:
        """The samples from `host_s` on, oldest first."""
        return [
            sample
            for part in (self._coarse, self._fine)
            for sample in part
            if sample.host_s >= host_s
        ]

    async def record(self, bridge: Bridge) -> None:
        """Takes a sample every second until cancelled, by the time of the running event loop."""
        loop = asyncio.get_running_loop()
        while True:
            self.add(bridge.latest(), loop.time())
            await asyncio.sleep(_FINE_S)
