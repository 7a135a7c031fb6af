"""The height of the nozzle above the bed, from an eddy current probe."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from contextlib import suppress
from statistics import fmean
from typing import TYPE_CHECKING

from passo.config.probing import PROBE
from passo.errors import CommandError
from passo.probes.eddy import LEAST_POINTS, EddyCurve, EddyPoint, EddyProbe

if TYPE_CHECKING:
    from passo.board.eddy import EddyReader
    from passo.motion.rig import Rig
    from passo.motion.triggered_moves import Interrupts, TriggeredMoves

_SETTLE_S = 0.05  # after a stop
_MEASURE_S = 0.1
_POLL_S = 0.05
_PATIENCE_S = 1.0  # for values that are due
_KEPT_S = 5.0  # of past values


class EddyGauge:
    """Measures with the eddy current probe of one printer. Call it with the motion lock held.
    `points` is the active calibration, and `drive_current` the active current of the coil. Methods
    raise CommandError if the sensor fails, Stopped after M108 or M410, and MachineError."""

    def __init__(
        self, rig: Rig, interrupts: Interrupts, triggered: TriggeredMoves, probe: EddyProbe
    ) -> None:
        self._rig, self._interrupts, self._triggered = rig, interrupts, triggered
        self._probe = probe
        self._values: list[tuple[float, float]] = []
        self.drive_current = probe.drive_current
        self.points: Sequence[EddyPoint] = probe.calibration

    @property
    def reader(self) -> EddyReader:
        """The sensor on its board, with the active settings. A sensor without a calibration counts
        as far from the bed."""
        reader = self._triggered.endstops.eddies[PROBE]
        reader.drive_current = self.drive_current
        reader.threshold_hz = self._probe.max_coil_hz
        if len(self.points) >= LEAST_POINTS:
            curve = EddyCurve(self.points)
            reader.threshold_hz = curve.frequency_hz(self._probe.trigger_height_mm)
        return reader

    @property
    def curve(self) -> EddyCurve:
        """The relation of height and frequency. Raises CommandError without a calibration."""
        if len(self.points) < LEAST_POINTS:
            raise CommandError.of("probe.not-calibrated")
        return EddyCurve(self.points)

    async def begin(self) -> None:
        """Starts the values."""
        self._values = []
        self.reader.start(self._rig.queue.base)
        await self._rig.queue.catch_up()

    def end(self) -> None:
        """Stops the values. A sensor that does not answer any more is no error here."""
        reader = self.reader
        if self._interrupts.halted:
            reader.running = False
        elif reader.running:
            with suppress(CommandError):
                reader.stop()

    async def height_mm(self) -> float:
        """The height of the nozzle above the bed at the probe, by the calibration, while the
        machine stands still; its mean over 0.1 s."""
        curve, hz = self.curve, await self.frequency_hz()
        height = curve.height_mm(hz)
        if height is None:
            low, high = curve.range_mm
            limit = f"{low:g} to {high:g} mm"
            raise CommandError.of("probe.out-of-range", value=f"{hz:.0f} Hz", limit=limit)
        return height

    async def frequency_hz(self) -> float:
        """The mean frequency over 0.1 s, while the machine stands still."""
        start_s = self._rig.queue.now_s + _SETTLE_S
        end_s = start_s + _MEASURE_S
        while self.newest_s < end_s:
            if self._rig.queue.now_s > end_s + _PATIENCE_S:
                raise CommandError.of(
                    "probe.sensor", value=self.reader.place, found="it gives no values"
                )
            await self.pass_time(_POLL_S)
        return fmean(self.between(start_s, end_s))

    async def pass_time(self, seconds: float) -> None:
        """Lets print time pass, and takes the values that have arrived."""
        queue = self._rig.queue
        end = queue.now + seconds * queue.hz
        await queue.until(lambda: queue.now >= end or bool(self._interrupts.halted))
        self._interrupts.raise_if_interrupted()
        self.take()

    def take(self) -> list[tuple[float, float]]:
        """Takes the values that have arrived, and returns them: print time in s, and Hz."""
        reader = self.reader
        reader.poll()
        fresh = reader.values()
        self._values += fresh
        if self._values:
            oldest = bisect_left(self._values, (self._values[-1][0] - _KEPT_S,))
            del self._values[:oldest]
        return fresh

    @property
    def newest_s(self) -> float:
        """The print time of the last value; -1 without one."""
        return self._values[-1][0] if self._values else -1.0

    def between(self, start_s: float, end_s: float) -> list[float]:
        """The frequencies within a span of print time of the last seconds."""
        first = bisect_left(self._values, (start_s,))
        last = bisect_right(self._values, (end_s, 0.0))
        return [hz for _, hz in self._values[first:last]]
