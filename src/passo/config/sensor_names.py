"""Named sensors, from the tables of Klipper and Marlin."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, get_args

from passo.config.findings import Finding, table, tables
from passo.config.i2c_sensors import I2C_KINDS
from passo.config.sensors import AnySensor
from passo.config.thermistor import Ntc

_Values = Mapping[str, str | float]
KINDS: tuple[str, ...] = tuple(
    kind
    for model in get_args(get_args(AnySensor)[0])
    for kind in get_args(model.model_fields["kind"].annotation)
)
SHOWN_KINDS = ("host", "chip", "combined", *I2C_KINDS)  # of sensors without a heater
_MAX_NEAR = 6


class NamedSensor(NamedTuple):
    """A sensor of a table: its `values` in the form of a machine file, the `data` from which they
    come, and the project that has it."""

    name: str
    values: _Values
    data: str
    source: str


def _points(name: str, *points: tuple[float, float]) -> NamedSensor:
    """A thermistor by three points, °C and ohm."""
    first, second, third = points
    ntc = Ntc.through(first, second, third)
    data = ", ".join(f"{celsius:g} °C {ohm:g} Ω" for celsius, ohm in points)
    values = _thermistor(_digits(ntc.r25_ohm, 6), _digits(ntc.beta_k, 6), _digits(ntc.c_per_k, 6))
    return NamedSensor(name, values, data, "Klipper")


def _beta(name: str, beta_k: float) -> NamedSensor:
    return NamedSensor(
        name, _thermistor(100_000, beta_k), f"25 °C 100000 Ω, β {beta_k:g} K", "Klipper"
    )


def _table(
    number: int,
    what: str,
    r25_ohm: float,
    beta_k: float,
    c_per_k: float,
    fit: str,
    pullup_ohm: int = 0,
) -> NamedSensor:
    """A thermistor from one of Marlin's tables, fitted by least squares over a range. `fit` has the
    range and the largest deviation from the table, °C; `pullup_ohm` is the pull-up resistor if it
    is not 4700 Ω."""
    values = dict(_thermistor(r25_ohm, beta_k, c_per_k))
    if pullup_ohm:
        values["pullup_ohm"] = float(pullup_ohm)
    low, high, off = fit.split()
    data = f"{what}; {low} to {high} °C within {off} °C of the table"
    return NamedSensor(f"Marlin {number}", values, data, "Marlin")


def _other(name: str, source: str, data: str, **values: str | float) -> NamedSensor:
    return NamedSensor(name, values, data, source)


def _thermistor(r25_ohm: float, beta_k: float, c_per_k: float = 0.0) -> _Values:
    return {"kind": "thermistor", "r25_ohm": float(r25_ohm), "beta_k": beta_k, "c_per_k": c_per_k}


def _digits(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")


NAMED = (
    _points("EPCOS 100K B57560G104F", (25, 100_000), (150, 1641.9), (250, 226.15)),
    _points("ATC Semitec 104GT-2", (20, 126_800), (150, 1360), (300, 80.65)),
    _points("ATC Semitec 104NT-4-R025H42G", (25, 100_000), (160, 1074), (300, 82.78)),
    _points("Generic 3950", (25, 100_000), (150, 1770), (250, 230)),
    _points("SliceEngineering 450", (25, 500_000), (200, 3734), (400, 240)),
    _points("TDK NTCG104LH104JT1", (25, 100_000), (50, 31_230), (125, 2066)),
    _beta("Honeywell 100K 135-104LAG-J01", 3974.0),
    _beta("NTC 100K MGB18-104F39050L32", 4100.0),
    _beta("NTC 100K beta 3950", 3950.0),
    _other("PT100 INA826", "Klipper", "amplifier of E3D on 5 V", kind="pt100-amplifier"),
    _table(1, "EPCOS 100 kΩ", 97_290, 4658.6, 1.068e-7, "15 300 1.3"),
    _table(2, "ATC Semitec 204GT-2, 200 kΩ", 192_020, 4909.8, 8.153e-8, "15 300 1.2"),
    _table(3, "Mendel-Parts 100 kΩ", 95_123, 4859.0, 1.423e-7, "15 300 2.0"),
    _table(4, "10 kΩ, not for hotends", 9811.6, 3971.0, 0.0, "0 300 0.9"),
    _table(5, "ATC Semitec 104GT-2, 104NT-4-R025H42G", 99_005, 4682.8, 6.504e-8, "15 300 2.2"),
    _table(7, "Honeywell 135-104LAG-J01", 98_092, 3939.5, 0.0, "15 300 0.5"),
    _table(8, "Vishay NTCS0603E3104FXT", 97_386, 3951.5, 1.669e-9, "15 300 0.5", 10_000),
    _table(9, "GE Sensing AL03006-58.2K-97-G1", 97_789, 3960.3, 4.749e-9, "15 300 0.5"),
    _table(10, "RS PRO 198-961", 97_767, 3968.7, 5.191e-9, "15 300 0.6"),
    _table(11, "Keenovo mats, Wanhao i3, β 3950", 97_324, 3934.5, 0.0, "15 300 0.6"),
    _table(12, "Vishay NTCS0603E3104FXT, Makibox bed", 92_431, 5502.9, 1.28e-7, "20 150 2.3"),
    _table(13, "Hisens up to 300 °C, β 3950", 97_306, 5038.3, 1.618e-7, "15 300 0.4"),
    _table(14, "bed of the Ender-5 S1, β 4092", 99_009, 4487.3, 0.0, "15 275 3.6"),
    _table(18, "ATC Semitec 204GT-2, Dagoma", 92_263, 5096.4, 1.283e-7, "15 300 2.1"),
    _table(30, "Kis3d heating mat, β 3950", 95_000, 4985.6, 5.66e-8, "15 300 1.0"),
    _table(51, "EPCOS 100 kΩ", 92_552, 4730.7, 1.288e-7, "15 300 0.9", 1000),
    _table(52, "ATC Semitec 204GT-2, 200 kΩ", 177_830, 5006.6, 1.089e-7, "15 300 2.0", 1000),
    _table(55, "ATC Semitec 104GT-2", 91_974, 4814.4, 1.033e-7, "15 300 0.6", 1000),
    _table(60, "Maker's Tool Works bed, β 3950", 97_637, 3940.8, 8.732e-10, "15 272 0.5"),
    _table(61, "Formbot, Vivedino, 350 °C, β 3950", 97_755, 4824.6, 1.39e-7, "15 300 0.9"),
    _table(67, "SliceEngineering 450 °C, 500 kΩ", 456_160, 4801.7, 1.448e-7, "20 450 1.3"),
    _table(70, "bq Hephestos 2", 90_183, 5108.3, 1.081e-7, "15 270 1.6"),
    _table(71, "Honeywell 135-104LAF-J01", 100_090, 3992.2, 3.866e-9, "15 300 0.4"),
    _table(75, "MGB18-104F39050L32, heating mats", 99_996, 4870.5, 1.419e-7, "15 200 0.1"),
    _table(99, "Wanhao i3 with 10 kΩ", 99_997, 4613.3, 8.932e-8, "15 300 0.1", 10_000),
    _table(202, "Copymaster 3D, 200 kΩ", 224_190, 5135.2, 1.197e-7, "15 300 0.6"),
    _table(501, "Zonestar, Tronxy X3A", 93_564, 5395.5, 1.83e-7, "15 300 1.8"),
    _table(2000, "TDK NTCG104LH104KT1", 100_030, 5068.1, 7.12e-8, "15 125 0.1"),
    _other("Marlin 110", "Marlin", "PT100, 1 kΩ", kind="pt100", pullup_ohm=1000.0),
    _other("Marlin 147", "Marlin", "PT100, 4.7 kΩ", kind="pt100", pullup_ohm=4700.0),
    _other("Marlin 1010", "Marlin", "PT1000, 1 kΩ", kind="pt1000", pullup_ohm=1000.0),
    _other("Marlin 1022", "Marlin", "PT1000, 2.2 kΩ", kind="pt1000", pullup_ohm=2200.0),
    _other("Marlin 1047", "Marlin", "PT1000, 4.7 kΩ", kind="pt1000", pullup_ohm=4700.0),
    _other("Marlin 20", "Marlin", "PT100, INA826 on 5 V", kind="pt100-amplifier"),
    _other(
        "Marlin 21",
        "Marlin",
        "the same, converter of 3.3 V",
        kind="pt100-amplifier",
        full_scale_v=3.3,
    ),
    _other("Marlin -1", "Marlin", "thermocouple, AD595", kind="ad595"),
    _other("Marlin -4", "Marlin", "thermocouple, AD8495", kind="ad8495"),
)


def _folded(name: object) -> str:
    """The name without case, blanks and hyphens; a number of Marlin keeps its sign, as in -1."""
    text = str(name).casefold().strip()
    number = re.fullmatch(r"(?:marlin)?[\s_]*(-?\d+)", text)
    return number[1] if number else re.sub(r"[\s_-]+", "", text)


_BY_NAME: dict[str, _Values] = {
    **{_folded(sensor.name): sensor.values for sensor in NAMED},
    **{_folded(kind): {"kind": kind} for kind in KINDS},
}


def values_of(name: str) -> _Values | None:
    """The values of a named sensor, in the form of a machine file; None for an unknown name."""
    return _BY_NAME.get(_folded(name))


def put_sensor_names(data: dict[str, Any]) -> Iterator[Finding]:
    """Replaces the name of each sensor by its values: `sensor = "NAME"`, or `kind = "NAME"` with
    further keys, which override the table's."""
    for part, kinds in (("heaters", KINDS), ("sensors", (*KINDS, *SHOWN_KINDS))):
        for name, content in list(tables(data, part)):
            yield from _put_sensor_name(data, (part, name), content, kinds)


def _put_sensor_name(
    data: dict[str, Any], part: tuple[str, str], content: Mapping[str, Any], kinds: tuple[str, ...]
) -> Iterator[Finding]:
    """Replaces the name of the sensor of one part, whose own kinds of sensors are `kinds`."""
    keys = table(content, "sensor")
    word = keys.get("kind") if keys else content.get("sensor")
    if not isinstance(word, str | int) or isinstance(word, bool) or (word in kinds and keys):
        return
    known = {"kind": word} if word in kinds else _BY_NAME.get(_folded(word))
    if known is None:
        path = (*part, "sensor", *(["kind"] if keys else []))
        limit = f"one of {', '.join(kinds)}, or the name of a sensor"
        yield Finding("config.value", path, word, limit, _near(str(word)))
        known, keys = {"kind": "thermistor"}, {}
    data[part[0]][part[1]] = {**content, "sensor": {**known, **keys, "kind": known["kind"]}}


def _near(word: str) -> str:
    """A hint with the most similar sensor names."""
    from difflib import get_close_matches

    names = {_folded(sensor.name): sensor.name for sensor in NAMED} | {kind: kind for kind in KINDS}
    parts = [part for part in re.findall(r"[a-z]+|\d+", word.casefold()) if len(part) > 2]
    close = [key for key in names if len(word) > 2 and _folded(word) in key]
    close += get_close_matches(_folded(word), names, n=_MAX_NEAR, cutoff=0.5)
    close += [key for key in names if any(part in key for part in parts)]
    if not close:
        return "The sensors that have names are in docs/reference/sensors.md"
    near = list(dict.fromkeys(names[key] for key in close))[:_MAX_NEAR]
    quoted = ", ".join(repr(name) for name in near)
    return f"Did you mean {quoted}?" if len(near) == 1 else f"Names like it: {quoted}"


_HEAD = """# Sensors by name

Made from `passo.config.sensor_names`. In a machine file such a name stands for the whole sensor, or
for its `kind` where further keys follow, which count more than the table:

```toml
[heaters.hotend]
sensor = "ATC Semitec 104GT-2"

[heaters.bed]
sensor = { kind = "Marlin 1", pullup_ohm = 2200.0 }
```

Case, blanks and hyphens do not matter; `sensor = 5` is `Marlin 5`, as in `TEMP_SENSOR_0 5`. The
pull-up resistor is the board's (4700 Ω unless its file states another) except where a row has one.
The equation of a thermistor is in [heat](../explanation/heat.md#sensors).

Klipper's thermistors follow from the points of its table, Marlin's are fitted to its tables of the
same numbers in the least squares. Marlin's 6, 15, 17, 22, 23, 66, 503 to 505, 512 and 666 are not
here: no such equation follows their tables within 4 °C. Write one of them as `kind = "table"`.
Sensors on an SPI bus (`max6675`, `max31855`, `max31856`, `max31865`) need pins.

| name | kind | R25, Ω | β, K | C | pull-up, Ω | data | table of |
|---|---|--:|--:|--:|--:|---|---|
"""


def reference() -> str:
    """The page docs/reference/sensors.md."""
    rows: list[str] = []
    for sensor in NAMED:
        keys = ("kind", "r25_ohm", "beta_k", "c_per_k", "pullup_ohm")
        cells = [_cell(sensor.values.get(key, "")) for key in keys]
        rows.append(f"| {' | '.join((sensor.name, *cells, sensor.data, sensor.source))} |\n")
    return _HEAD + "".join(rows)


def _cell(value: str | float) -> str:
    return value if isinstance(value, str) else f"{value:.6g}"
