"""Watches the temperature sensors of a machine that no heater uses."""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import TYPE_CHECKING, Literal

from passo.board.reading import Reading
from passo.board.shown_sensors import Broken, SensorReading
from passo.config.i2c_sensors import I2cSensor
from passo.config.shown_sensors import CombinedSensor, HostSensor
from passo.errors import MachineError, Problem
from passo.printer.status import SensorStatus

if TYPE_CHECKING:
    from collections.abc import Callable

    from passo.config.shown_sensors import ShownSensor
    from passo.errors import PassoError
    from passo.printer.live_rig import LiveRig
    from passo.printer.state import State

_log = logging.getLogger(__name__)

_HOST_S = 1.0  # between two readings of this computer's temperature
_LASTS_S = 1.0  # a fault counts after this time
_CHIP_FAULTS = ("silent", "garbled", "other-chip")  # of a chip on I2C, which stop nothing
_FOUND_FAULTS = (*_CHIP_FAULTS, "apart")  # what was found is a text
_BROKEN = ("open", "short", *_FOUND_FAULTS)
FaultKind = Broken | Literal["low", "high"]


@dataclass(frozen=True, slots=True)
class SensorFault:
    """A sensor without a heater is broken, or reads a temperature beyond `limit`. `place` and
    `found` are the place of a chip on I2C and what came from it, or the limit of a combined sensor
    and what was read. `str()` gives a message with the next action."""

    sensor: str
    kind: FaultKind
    celsius: float
    limit: float
    place: str = ""
    found: str = ""

    @property
    def problem(self) -> Problem:
        """The fault as a problem of the catalogue."""
        if self.kind in _FOUND_FAULTS:
            values = {"axis": self.sensor, "value": self.found, "limit": self.place}
        else:
            values = {"axis": self.sensor, "value": self.celsius, "limit": self.limit}
        return Problem(f"sensor.{self.kind}", values=values)

    def __str__(self) -> str:
        """The message of the fault."""
        return str(self.problem)


class _Seen:
    """What has been seen of one sensor."""

    def __init__(self) -> None:
        self.found = SensorReading(Reading(None))
        self.lowest_c: float | None = None
        self.highest_c: float | None = None
        self.kind: FaultKind = ""  # of the last reading
        self.since_s = 0.0  # host time since which it has been of this kind
        self.fault: FaultKind = ""  # that has been reported


class SensorWatch:
    """The temperature sensors of one printer that no heater uses. `halt` halts the printer, for a
    sensor whose faults do."""

    def __init__(self, rig: LiveRig, state: State, halt: Callable[[PassoError, str], None]) -> None:
        self._rig, self._state, self._halt = rig, state, halt
        self._sensors = rig.machine.sensors
        self._seen = {name: _Seen() for name in self._sensors}
        self._host_s = -_HOST_S
        self._loop = asyncio.get_running_loop()

    def time_passed(self) -> None:
        """Reads the sensors, and handles faults that last."""
        now_s = self._loop.time()
        host = now_s >= self._host_s + _HOST_S
        if host:
            self._host_s = now_s
        if not (self._state.halted or self._rig.queue.interrupted):
            self._rig.connection.work_i2c_sensors()
        for name, shown in self._sensors.items():
            seen = self._seen[name]
            if isinstance(shown.sensor, HostSensor):
                if host:
                    seen.found = SensorReading(_of_host(shown.sensor))
            elif isinstance(shown.sensor, CombinedSensor):
                seen.found = self._combined(shown.sensor)
            else:
                seen.found = self._rig.connection.sensor(name, self._rig.queue.board_now)
            self._take(name, shown, seen, now_s)

    def _combined(self, sensor: CombinedSensor) -> SensorReading:
        """The temperature that follows from others; unknown while one of them is, and broken while
        they are too far apart."""
        connection, found = self._rig.connection, list[float]()
        for name in sensor.of:
            if name in self._sensors:
                celsius = self.celsius(name)
            else:
                celsius = connection.reading(name, self._rig.queue.board_now).current_c
            if celsius is None:
                return SensorReading(Reading(None))
            found.append(celsius)
        apart_c = max(found) - min(found)
        if sensor.max_deviation_c is not None and apart_c > sensor.max_deviation_c:
            return SensorReading(Reading(None), "apart", f"{apart_c:.1f} °C")
        return SensorReading(Reading({"mean": fmean, "min": min, "max": max}[sensor.by](found)))

    def _take(
        self,
        name: str,
        shown: ShownSensor,
        seen: _Seen,
        now_s: float,
    ) -> None:
        celsius, broken = seen.found.reading.current_c, seen.found.broken
        if celsius is None and not broken:
            return
        kind = _kind_of(shown, celsius, broken)
        if kind != seen.kind:
            seen.kind, seen.since_s = kind, now_s
        if celsius is not None and not broken:
            seen.lowest_c = min(celsius, celsius if seen.lowest_c is None else seen.lowest_c)
            seen.highest_c = max(celsius, celsius if seen.highest_c is None else seen.highest_c)
        if kind != seen.fault and (not kind or now_s >= seen.since_s + _LASTS_S):
            seen.fault = kind
            if kind:
                self._failed(shown, self._fault(name, kind))

    def _fault(self, name: str, kind: FaultKind) -> SensorFault:
        seen, shown = self._seen[name], self._sensors[name]
        limit = shown.min_c if kind == "low" else shown.max_c
        place = _place_of(shown.sensor)
        return SensorFault(name, kind, seen.found.reading.number_c, limit, place, seen.found.found)

    def _failed(self, shown: ShownSensor, fault: SensorFault) -> None:
        if self._state.halted:
            return
        if shown.on_fault == "machine" and fault.kind not in _CHIP_FAULTS:
            self._halt(MachineError([fault.problem]), fault.problem.sentence)
            return
        self._state.announce(_log, logging.WARNING, str(fault), fault.problem)

    def celsius(self, name: str) -> float | None:
        """The temperature of a sensor now; None if it is unknown or broken."""
        seen = self._seen[name]
        return None if seen.kind in _BROKEN else seen.found.reading.current_c

    def broken(self, name: str) -> SensorFault | None:
        """The fault of a broken sensor, once it has been reported."""
        fault = self._seen[name].fault
        return self._fault(name, fault) if fault in _BROKEN else None

    def status(self) -> dict[str, SensorStatus]:
        """The status of all sensors, by their names."""
        return {
            name: SensorStatus(
                None if seen.kind in _BROKEN else seen.found.reading.celsius,
                seen.lowest_c,
                seen.highest_c,
                seen.fault,
                seen.found.reading.age_s,
                seen.found.humidity,
                seen.found.pressure_hpa,
            )
            for name, seen in self._seen.items()
        }


def _of_host(sensor: HostSensor) -> Reading:
    with suppress(OSError, ValueError):
        return Reading(int(Path(sensor.path).read_text(encoding="ascii")) / 1000)
    return Reading(None)


def _place_of(sensor: object) -> str:
    """The bus and the address of a chip on I2C, as an owner looks for them, or the limit of a
    combined sensor; empty for other sensors."""
    if isinstance(sensor, CombinedSensor):
        return f"{sensor.max_deviation_c:g} °C" if sensor.max_deviation_c else ""
    if not isinstance(sensor, I2cSensor):
        return ""
    bus = sensor.i2c_bus or f"{sensor.scl_pin} and {sensor.sda_pin}"
    return f"address {sensor.used_address} on I2C ({bus})"


def _kind_of(shown: ShownSensor, celsius: float | None, broken: Broken) -> FaultKind:
    if broken or celsius is None:
        return broken
    if celsius < shown.min_c:
        return "low"
    return "high" if celsius > shown.max_c else ""
