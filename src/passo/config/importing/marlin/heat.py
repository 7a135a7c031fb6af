"""Heaters, their sensors and protections, fans and tools."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.config.importing.draft import MOTORS_ALONE, NO_BUS, UNKNOWN_SENSOR, bad
from passo.config.importing.numbers import plain
from passo.config.sensor_names import values_of

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.marlin.conversion import Job
    from passo.config.importing.numbers import Read

_CONVERTERS = {-2: "max6675", -3: "max31855", -5: "max31865"}
_DUMMIES = (998, 999)
_CUSTOM = 1000
_FULL = 255
_MOST_EXTRUDERS = 8
# MK4duo's and StuFW's numbers: R25 in ohm and β in K, or another sensor.
_MK4DUO: dict[int, tuple[float, float] | str] = {
    1: (100_000, 4092),
    2: (100_000, 3950),
    3: (200_000, 4338),
    4: (100_000, 4725),
    5: (100_000, 3974),
    6: (100_000, 4100),
    7: (100_000, 3952),
    8: (100_000, 3960),
    20: "pt100-amplifier",
    -1: "ad595",
    -2: "ad8495",
}
_MK4DUO_CONVERTERS = {-3: "max6675", -4: "max31855"}


def count_extruders(job: Job) -> None:
    """Sets the number of extruders and the names of the hotends. Raises ConfigError."""
    count = job.defines.number("EXTRUDERS")
    job.extruders = count.whole(0, _MOST_EXTRUDERS) if count else 1
    single = job.defines.on("SINGLENOZZLE")
    for number in range(min(job.extruders, 1) if single else job.extruders):
        if _has_sensor(job, f"TEMP_SENSOR_{number}"):
            job.hotends[number] = f"hotend{number}" if number else "hotend"


def put_heat(job: Job) -> None:
    """Converts all heaters, then fans and tools. A heater without a sensor or a maximum is left
    out."""
    for number, name in [*job.hotends.items()]:
        if not _put_part(job, name, str(number)):
            del job.hotends[number]
    for mark in ("BED", "CHAMBER"):
        if _has_sensor(job, f"TEMP_SENSOR_{mark}"):
            _put_part(job, mark.lower(), mark)
    job.part("FAN_PIN", lambda: _put_part_fan(job))
    for number in job.hotends:
        job.part(f"E{number}_AUTO_FAN_PIN", lambda number=number: _put_hotend_fan(job, number))
    if job.defines.on("USE_CONTROLLER_FAN", "CONTROLLERFAN"):
        job.part("USE_CONTROLLER_FAN", lambda: _put_controller_fan(job))
    _put_tools(job)


def _put_part(job: Job, name: str, mark: str) -> bool:
    return job.part(f"TEMP_SENSOR_{mark}", lambda: _put_heater(job, name, mark))


def _has_sensor(job: Job, name: str) -> bool:
    found = job.defines.number(name)
    return found is not None and found.value != 0


def _put_heater(job: Job, name: str, mark: str) -> None:
    """Converts a heater; `mark` is in the names of its defines: 0, BED, CHAMBER."""
    path, defines, hotend = ("heaters", name), job.defines, mark.isdigit()
    sensor = job.needed(f"TEMP_SENSOR_{mark}")
    job.draft.put((*path, "kind"), "hotend" if hotend else mark.lower(), sensor.place)
    job.rows("heater_pins", name=name, mark=mark)
    function = job.pins.functions.get(f"hotend{mark}" if hotend else mark.lower())
    own = (function and function.output, function and function.sensor)
    for key, define, pin in zip(("pin", "sensor_pin"), ("HEATER", "TEMP"), own, strict=True):
        if pin is None and (*path, key) not in job.draft.keys:
            limit = f"a pin: the board {job.pins.board.name} has none for this heater"
            raise bad(sensor.place, f"{define}_{mark}_PIN", "missing", limit)
    _put_sensor(job, path, sensor, mark)
    stem, older = (f"HEATER_{mark}", f"HOTEND_{mark}") if hotend else (mark, mark)
    job.rows("heater", sensor.place, name=name, stem=stem, older=older)
    pid = defines.on("PIDTEMP" if hotend else f"PIDTEMP{mark}")
    usual = "PID_MAX" if pid else "BANG_MAX"
    most = defines.number(usual if hotend else f"MAX_{mark}_POWER")
    if most is not None and 0 < most.value < _FULL:
        job.put((*path, "max_power"), most, 1 / _FULL)
    _put_control(job, name, mark, pid)
    middle = "" if hotend else f"{mark}_"
    protection = f"THERMAL_PROTECTION_{'HOTENDS' if hotend else mark}"
    if defines.on(protection):
        job.rows("protection", name=name, middle=middle)
    else:
        text = f"{protection} is off; Passo protects heater {name} all the same"
        job.changed(f"TEMP_SENSOR_{mark}", text)
    job.rows("arrival", name=name, middle=middle)


def _put_control(job: Job, name: str, mark: str, pid: bool) -> None:
    hotend, path = mark.isdigit(), ("heaters", name, "control", "kind")
    if hotend and job.defines.on("MPCTEMP"):
        job.draft.put(path, "model", job.place("MPCTEMP"))
        _put_model(job, ("heaters", name), int(mark))
    elif pid:
        job.draft.put(path, "pid", job.place("PIDTEMP" if hotend else f"PIDTEMP{mark}"))
        heater = "" if hotend else mark.lower()
        job.rows("pid", name=name, heater=heater, index=mark if hotend else "0")
    else:
        job.draft.put(path, "bang-bang", job.place(f"TEMP_SENSOR_{mark}"))
        job.rows("bang_bang", name=name, mark=mark)


def _put_model(job: Job, path: KeyPath, index: int) -> None:
    """Marlin's model: a block of heat capacity C, J/K, with a loss of h, W/K, under a power P, W.
    So its rise at full power is P/h, its time constant C/h, and that of the sensor 1/s where s is
    the responsiveness."""
    names = (
        "MPC_HEATER_POWER",
        "MPC_BLOCK_HEAT_CAPACITY",
        "MPC_AMBIENT_XFER_COEFF",
        "MPC_SENSOR_RESPONSIVENESS",
    )
    found = [job.defines.numbers(name) for name in names]
    values = [one[min(index, len(one) - 1)] for one in found if one]
    if len(values) < 4 or any(one.value <= 0 for one in values):
        job.decide("MPCTEMP", "the model is not complete: tune the heater with M303, then M500")
        return
    power, capacity, loss, quickness = values
    put, model = job.draft.put, (*path, "model")
    put((*model, "rise_c"), plain(power.value / loss.value), power.place)
    put((*model, "time_constant_s"), plain(capacity.value / loss.value), capacity.place)
    put((*model, "sensor_lag_s"), plain(1 / quickness.value), quickness.place)
    fan = job.defines.numbers("MPC_AMBIENT_XFER_COEFF_FAN255")
    if fan and job.defines.on("MPC_INCLUDE_FAN"):
        with_fan = fan[min(index, len(fan) - 1)]
        put((*model, "fan_loss"), plain(with_fan.value / loss.value - 1), with_fan.place)
    job.changed("MPCTEMP", "power, capacity and losses became the model of the heater")


def _put_sensor(job: Job, path: KeyPath, sensor: Read, mark: str) -> None:
    number, put = sensor.whole(-1000, 10_000), job.draft.put
    if number in _DUMMIES:
        limit = "a sensor: this one always reads the same, so that nothing would stop the heater"
        raise bad(sensor.place, sensor.name, str(number), limit)
    converters = _MK4DUO_CONVERTERS if job.mk4duo else _CONVERTERS
    if number in converters:
        _put_converter(job, path, sensor, converters[number], mark)
        return
    if job.mk4duo:
        done = _put_of_mk4duo(job, path, sensor, number)
    elif number == _CUSTOM:
        done = _put_custom(job, path, sensor, mark)
    elif done := values_of(f"Marlin {number}") is not None:
        put((*path, "sensor"), f"Marlin {number}", sensor.place)
    if not done:
        raise bad(sensor.place, sensor.name, str(number), UNKNOWN_SENSOR)


def _put_of_mk4duo(job: Job, path: KeyPath, sensor: Read, number: int) -> bool:
    """Converts a sensor by its number or its own values. False for an unknown one."""
    known, keys = _MK4DUO.get(number), (*path, "sensor")
    own = [job.defines.number(f"T{number}_{word}") for word in ("R25", "BETA")]
    r25, beta = (one.value if one else None for one in own)
    if r25 is not None and beta is not None:
        known = r25, beta
    pullup = job.defines.number("THERMISTOR_SERIES_RS")
    kind = known if isinstance(known, str) else "thermistor"
    job.draft.put((*keys, "kind"), kind, sensor.place)
    if isinstance(known, tuple):
        values = zip(
            ("r25_ohm", "beta_k", "pullup_ohm"), (*known, pullup and pullup.value), strict=False
        )
        for key, value in values:
            job.draft.put((*keys, key), None if value is None else float(value), sensor.place)
    return known is not None


def _put_custom(job: Job, path: KeyPath, sensor: Read, mark: str) -> bool:
    """Converts Marlin's 1000, whose equation is that of Passo: 1/T = A + ln R / β + C·(ln R)³.
    False if it lacks a value."""
    keys = (*path, "sensor")
    job.draft.put((*keys, "kind"), "thermistor", sensor.place)
    own = f"HOTEND{mark}" if mark.isdigit() else mark
    job.rows("custom_sensor", name=path[-1], own=own)
    return all((*keys, key) in job.draft.keys for key in ("r25_ohm", "beta_k"))


def _put_converter(job: Job, path: KeyPath, sensor: Read, kind: str, mark: str) -> None:
    """Converts a converter on the pins in the configuration, or on those of the board's SD card."""
    put, card = job.draft.put, job.pins.board.card
    put((*path, "sensor", "kind"), kind, sensor.place)
    for key, word, own in (
        ("clock_pin", "SCK", "sck"),
        ("miso_pin", "MISO", "miso"),
        ("mosi_pin", "MOSI", "mosi"),
    ):
        pin = job.pins.given(f"TEMP_{mark}_{word}_PIN", f"MAX31865_{word}_PIN") or card.get(own)
        if pin is None:
            raise bad(sensor.place, f"TEMP_{mark}_{word}_PIN", "missing", NO_BUS)
        put((*path, "sensor", key), pin, sensor.place)
    select = job.pins.given(f"TEMP_{mark}_CS_PIN", f"MAX6675_SS{mark}_PIN")
    if select is None and "MAX6675_SELECT" in job.pins.board.pins and mark == "0":
        select = "MAX6675_SELECT"
    if select is None:
        raise bad(
            sensor.place, f"TEMP_{mark}_CS_PIN", "missing", "the pin that selects the converter"
        )
    put((*path, "sensor_pin"), select, sensor.place)
    if kind == "max31865":
        job.rows("max31865", name=path[-1], mark=mark)


def _put_part_fan(job: Job) -> None:
    pin, board = job.pins.given("FAN_PIN", "FAN0_PIN"), job.pins.functions.get("fan0")
    if pin is not None or board is not None:
        job.draft.put(("fans", "part", "pin"), board and board.output, None)
        job.rows("part_fan")


def _put_hotend_fan(job: Job, number: int) -> None:
    hotend, define = job.hotends[number], f"E{number}_AUTO_FAN_PIN"
    pin, name = job.pins.given(define), f"{hotend}_fan"
    if pin is not None:
        job.draft.put(("fans", name, "pin"), pin, job.place(define))
        job.draft.put(("fans", name, "follows"), hotend, None)
        job.rows("hotend_fan", name=name)


def _put_controller_fan(job: Job) -> None:
    defines, path = job.defines, ("fans", "board")
    name = defines.first("USE_CONTROLLER_FAN", "CONTROLLERFAN")
    pin = job.pins.given("CONTROLLER_FAN_PIN", "CONTROLLERFAN_PIN")
    assert name is not None
    if pin is None:
        job.decide(name, "the pin of this fan is not in the file: add [fans.board] with it")
        return
    job.draft.put((*path, "pin"), pin, job.place("CONTROLLER_FAN_PIN", "CONTROLLERFAN_PIN"))
    job.changed(name, MOTORS_ALONE)
    motors = [key[1] for key in job.draft.keys if key[0] == "steppers" and key[2] == "steps_per_mm"]
    job.draft.put((*path, "follows_motors"), [*motors], defines.place(name))
    job.rows("board_fan")


def _put_tools(job: Job) -> None:
    """If there are several extruders, makes a tool for each, with the offset of its nozzle."""
    if job.extruders < 2:
        return
    offsets = [job.defines.numbers(f"HOTEND_OFFSET_{axis}") for axis in "XYZ"]
    tools: list[Any] = []
    for number in range(job.extruders):
        tool: dict[str, Any] = {"extruder": f"e{number}" if number else "e"}
        if job.hotends:
            tool["heater"] = job.hotends.get(number, job.hotends[min(job.hotends)])
        at = [one[number].value if one and number < len(one) else 0.0 for one in offsets]
        if any(at):
            tool["offset_mm"] = [float(mm) for mm in at]
        tools.append(tool)
    job.draft.put(("tools",), tools, job.place("EXTRUDERS"))
