"""The readings of a board's temperature sensors that no heater uses."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from passo import _core
from passo.board.configuration import Oids, adc_full, sensor_query

if TYPE_CHECKING:
    from collections.abc import Iterable

    from passo.board.description import BoardDescription, Sensor
    from passo.board.dictionary import Dictionary
    from passo.board.exchange import Values

Broken = Literal["", "open", "short"]
REPORTS = ("analog_in_state", "thermocouple_result")


@dataclass(frozen=True, slots=True)
class SensorReport:
    """A reading in °C, at this clock of the board. `broken` tells an open or a shorted sensor, for
    which the temperature is the end of the table."""

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
        self._adc_full = adc_full(dictionary)
        self.last: dict[str, SensorReport] = {}

    def take(self, reports: Iterable[tuple[str, Values]]) -> None:
        """Takes reports of the board, of the names `REPORTS`, oldest first."""
        for _, values in reports:
            oid = int(values["oid"])
            if (sensor := self._sensors.get(oid)) is None:
                continue
            clock = (int(values["next_clock"]) - self._rest[oid]) & 0xFFFFFFFF
            if sensor.spi is None:
                share = _sum(values) / self._adc_full
            else:
                share = _converted(sensor, int(values["value"]), int(values["fault"]))
            self.last[sensor.name] = SensorReport(
                _celsius(sensor, share), clock, _broken(sensor, share)
            )


def _sum(values: Values) -> int:
    """The newest reading in a report: older firmware sends one number."""
    data = values.get("values")
    return int.from_bytes(data[-2:], "little") if isinstance(data, bytes) else int(values["value"])


def _converted(sensor: Sensor, word: int, faults: int) -> float:
    """The fraction of full scale for a word of a converter; 0 for a short circuit, and full scale
    for any other fault."""
    value, fault = _core.read_converter(sensor.converter, word, faults)
    if fault == _core.ConverterFault.SHORT_CIRCUIT:
        return 0.0
    if fault in (_core.ConverterFault.NONE, _core.ConverterFault.OUT_OF_RANGE):
        return _core.converter_share(sensor.converter, value)
    return 1.0


def _celsius(sensor: Sensor, share: float) -> float:
    rows = sorted((share, celsius) for celsius, share in sensor.table)
    (low, at_low), (high, at_high) = rows[0], rows[-1]
    if not low < share < high:
        return at_low if share <= low else at_high
    for (s0, c0), (s1, c1) in itertools.pairwise(rows):
        if share <= s1:
            return c0 + (c1 - c0) * (share - s0) / (s1 - s0)
    return at_high


def _broken(sensor: Sensor, share: float) -> Broken:
    shares = [share for _, share in sensor.table]
    if min(shares) <= share <= max(shares):
        return ""
    return "open" if (share > max(shares)) == sensor.open_is_high else "short"
