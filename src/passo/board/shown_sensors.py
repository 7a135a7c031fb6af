"""The readings of a board's temperature sensors that no heater uses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from passo import _core
from passo.board.analog_inputs import REPORT, newest
from passo.board.configuration import Oids, adc_full, sensor_query
from passo.board.reading import Reading
from passo.config.sensor_tables import share_at

if TYPE_CHECKING:
    from collections.abc import Iterable

    from passo.board.description import BoardDescription, Sensor
    from passo.board.dictionary import Dictionary
    from passo.board.exchange import Values

Broken = Literal["", "open", "short", "silent", "garbled", "other-chip", "apart"]
REPORTS = (REPORT, "thermocouple_result")


@dataclass(frozen=True, slots=True)
class SensorReading:
    """What is known of a sensor without a heater: its temperature, whether it is `broken`, with
    what was `found` then, and what else it measures: % of relative humidity, hPa."""

    reading: Reading
    broken: Broken = ""
    found: str = ""
    humidity: float | None = None
    pressure_hpa: float | None = None


@dataclass(frozen=True, slots=True)
class SensorReport:
    """A reading in °C, at this clock of the board. `broken` is the fault of an open or a shorted
    sensor, whose temperature is the end of the table."""

    celsius: float
    clock: int
    broken: Broken = ""


class ShownSensors:
    """The last reports of the shown sensors of one board, by their names."""

    def __init__(self, board: BoardDescription, dictionary: Dictionary) -> None:
        oids = Oids.of(board).sensors
        self._sensors = {oids[s.name]: s for s in board.shown}
        self._rest = {
            oid: sensor_query(board, s, dictionary).rest_ticks for oid, s in self._sensors.items()
        }
        # rows (fraction of full scale, °C): share_at with these gives the temperature
        self._by_share = {
            oid: tuple(sorted((share, celsius) for celsius, share in s.table))
            for oid, s in self._sensors.items()
        }
        self._adc_full = adc_full(dictionary)
        self.last: dict[str, SensorReport] = {}

    @property
    def oids(self) -> set[int]:
        """The numbers of the objects."""
        return set(self._sensors)

    def take(self, reports: Iterable[tuple[str, Values]]) -> None:
        """Takes reports of these sensors, of the names `REPORTS`, oldest first."""
        for _, values in reports:
            oid = int(values["oid"])
            sensor = self._sensors[oid]
            clock = (int(values["next_clock"]) - self._rest[oid]) & 0xFFFFFFFF
            if sensor.spi is None:
                share = newest(values) / self._adc_full
            else:
                share = _converted(sensor, int(values["value"]), int(values["fault"]))
            celsius = share_at(self._by_share[oid], share)
            self.last[sensor.name] = SensorReport(celsius, clock, _broken(sensor, share))


def _converted(sensor: Sensor, word: int, faults: int) -> float:
    """The fraction of full scale for a word of a converter; 0 for a short circuit, and full scale
    for any other fault."""
    value, fault = _core.read_converter(sensor.converter, word, faults)
    if fault == _core.ConverterFault.SHORT_CIRCUIT:
        return 0.0
    if fault in (_core.ConverterFault.NONE, _core.ConverterFault.OUT_OF_RANGE):
        return _core.converter_share(sensor.converter, value)
    return 1.0


def _broken(sensor: Sensor, share: float) -> Broken:
    shares = [share for _, share in sensor.table]
    if min(shares) <= share <= max(shares):
        return ""
    return "open" if (share > max(shares)) == sensor.open_is_high else "short"
