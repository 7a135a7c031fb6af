"""Heaters, their sensors and protections, fans and tools."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.config.importing.draft import MOTORS_ALONE, bad
from passo.config.importing.marlin.conversion import plain
from passo.config.sensor_names import values_of
from passo.errors import ConfigError

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
    pins = (
        ("pin", "output", (f"HEATER_{mark}_PIN",)),
        ("sensor_pin", "sensor", (f"TEMP_{mark}_PIN",)),
    )
    for key, role, names in pins:
        pin = job.pins.given(*names, analog=role == "sensor")
        if pin is not None:
            job.draft.put((*path, key), pin, job.place(*names))
            continue
        function = job.pins.functions.get(f"hotend{mark}" if hotend else mark.lower())
        if function is None or getattr(function, role) is None:
            limit = f"a pin: the board {job.pins.board.name} has none for this heater"
            raise bad(sensor.place, names[0], "missing", limit)
    _put_sensor(job, path, sensor, mark)
    stems = (f"HEATER_{mark}", f"HOTEND_{mark}") if hotend else (mark,)
    for key, word in (("min_c", "MINTEMP"), ("max_c", "MAXTEMP")):
        found = defines.number(*(f"{stem}_{word}" for stem in stems))
        if found is None:
            place = sensor.place
            raise ConfigError.of(
                "config.missing-key",
                place.file,
                place.line,
                key=f"{stems[0]}_{word}",
                limit="a value, without which the heater is not safe",
            )
        job.put((*path, key), found)
    power = {"BED": "MAX_BED_POWER", "CHAMBER": "MAX_CHAMBER_POWER"}.get(mark)
    pid = defines.on("PIDTEMP" if hotend else f"PIDTEMP{mark}")
    most = defines.number(power or ("PID_MAX" if pid else "BANG_MAX"))
    if most is not None and 0 < most.value < _FULL:
        job.put((*path, "max_power"), most, 1 / _FULL)
    _put_control(job, path, mark, pid)
    _put_protection(job, path, mark)
    _put_arrival(job, path, mark)


def _put_control(job: Job, path: KeyPath, mark: str, pid: bool) -> None:
    defines, put, control = job.defines, job.draft.put, (*path, "control")
    hotend = mark.isdigit()
    if hotend and defines.on("MPCTEMP"):
        put((*control, "kind"), "model", job.place("MPCTEMP"))
        _put_model(job, path, int(mark))
        return
    if pid:
        put((*control, "kind"), "pid", job.place("PIDTEMP" if hotend else f"PIDTEMP{mark}"))
        for gain in ("p", "i", "d"):
            own = f"DEFAULT_{'' if hotend else mark.lower()}K{gain}"
            gains = defines.numbers(f"{own}_LIST", own)
            if gains:
                at = min(int(mark), len(gains) - 1) if hotend else 0
                job.put((*control, f"k{gain}"), gains[at])
        for key, define in (("drive_min", "PID_DRIVE_MIN"), ("drive_max", "PID_DRIVE_MAX")):
            limits = defines.numbers(define)
            if limits:
                at = min(int(mark), len(limits) - 1) if hotend else 0
                job.put((*control, key), limits[at], 1 / _FULL)
        return
    place = defines.place(f"TEMP_SENSOR_{mark}")
    put((*control, "kind"), "bang-bang", place)
    job.put((*control, "hysteresis_c"), defines.number(f"{mark}_HYSTERESIS"))
    job.put((*control, "interval_s"), defines.number(f"{mark}_CHECK_INTERVAL"), 1e-3)


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


def _put_protection(job: Job, path: KeyPath, mark: str) -> None:
    defines, keys = job.defines, (*path, "protection")
    middle = "" if mark.isdigit() else f"{mark}_"
    name = "THERMAL_PROTECTION_HOTENDS" if mark.isdigit() else f"THERMAL_PROTECTION_{mark}"
    if not defines.on(name):
        sensor = f"TEMP_SENSOR_{mark}"
        job.changed(sensor, f"{name} is off; Passo protects heater {path[1]} all the same")
        return
    for key, define in (
        ("watch_s", f"WATCH_{middle}TEMP_PERIOD"),
        ("watch_rise_c", f"WATCH_{middle}TEMP_INCREASE"),
        ("runaway_s", f"THERMAL_PROTECTION_{middle}PERIOD"),
        ("runaway_c", f"THERMAL_PROTECTION_{middle}HYSTERESIS"),
    ):
        found = defines.number(define)
        if found is not None and found.value > 0:
            job.put((*keys, key), found)


def _put_arrival(job: Job, path: KeyPath, mark: str) -> None:
    middle = "" if mark.isdigit() else f"{mark}_"
    for key, word in (
        ("window_c", "WINDOW"),
        ("leaves_c", "HYSTERESIS"),
        ("seconds", "RESIDENCY_TIME"),
    ):
        found = job.defines.number(f"TEMP_{middle}{word}")
        if found is not None and (found.value > 0 or key == "seconds"):
            job.put((*path, "arrival", key), found)


def _put_sensor(job: Job, path: KeyPath, sensor: Read, mark: str) -> None:
    number, put = sensor.whole(-1000, 10_000), job.draft.put
    if number in _DUMMIES:
        limit = "a sensor: this one always reads the same, so that nothing would stop the heater"
        raise bad(sensor.place, sensor.name, str(number), limit)
    converters = _MK4DUO_CONVERTERS if job.mk4duo else _CONVERTERS
    if number in converters:
        _put_converter(job, path, sensor, converters[number], mark)
        return
    keys: dict[str, Any] | None
    if job.mk4duo:
        keys = _of_mk4duo(job, number)
    elif number == _CUSTOM:
        keys = _custom(job, mark)
    else:
        if values_of(f"Marlin {number}") is not None:
            put((*path, "sensor"), f"Marlin {number}", sensor.place)
            return
        keys = None
    if keys is None:
        limit = "a sensor that Passo has; docs/reference/sensors.md lists them"
        raise bad(sensor.place, sensor.name, str(number), limit)
    for key, value in keys.items():
        put((*path, "sensor", key), value, sensor.place)


def _of_mk4duo(job: Job, number: int) -> dict[str, Any] | None:
    pullup = job.defines.number("THERMISTOR_SERIES_RS")
    more = {"pullup_ohm": pullup.value} if pullup else {}
    own = [job.defines.number(f"T{number}_{word}") for word in ("R25", "BETA")]
    r25, beta = (one.value if one else None for one in own)
    if r25 is None or beta is None:
        found = _MK4DUO.get(number)
        if isinstance(found, str):
            return {"kind": found}
        if found is None:
            return None
        r25, beta = found
    return {"kind": "thermistor", "r25_ohm": float(r25), "beta_k": float(beta)} | more


def _custom(job: Job, mark: str) -> dict[str, Any] | None:
    """Marlin's 1000, whose equation is that of Passo: 1/T = A + ln R / β + C·(ln R)³."""
    stem = f"HOTEND{mark}" if mark.isdigit() else mark
    words = ("PULLUP_RESISTOR_OHMS", "RESISTANCE_25C_OHMS", "BETA", "SH_C_COEFF")
    found = [job.defines.number(f"{stem}_{word}") for word in words]
    keys = ("pullup_ohm", "r25_ohm", "beta_k", "c_per_k")
    values = {key: float(one.value) for key, one in zip(keys, found, strict=True) if one}
    if not {"r25_ohm", "beta_k"} <= values.keys():
        return None
    return {"kind": "thermistor", **values}


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
            limit = "three pins for the converter's bus: Passo does not use the chip's SPI unit"
            raise bad(sensor.place, f"TEMP_{mark}_{word}_PIN", "missing", limit)
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
        ohms = job.defines.number(f"MAX31865_SENSOR_OHMS_{mark}")
        if ohms is not None:
            put((*path, "sensor", "r0_ohm"), ohms.whole(100, 1000), ohms.place)
        job.put(
            (*path, "sensor", "reference_ohm"),
            job.defines.number(f"MAX31865_CALIBRATION_OHMS_{mark}"),
        )


def _put_part_fan(job: Job) -> None:
    defines, put = job.defines, job.draft.put
    pin = job.pins.given("FAN_PIN", "FAN0_PIN")
    if pin is not None or "fan0" in job.pins.functions:
        path = ("fans", "part")
        place = job.place("FAN_PIN", "FAN0_PIN") if pin else None
        put((*path, "pin"), pin or job.pins.functions["fan0"].output, place)
        low = defines.number("FAN_MIN_PWM")
        if low is not None and low.value > 0:
            job.draft.put((*path, "min_power"), round(low.value / _FULL, 4), low.place)
        high = defines.number("FAN_MAX_PWM")
        if high is not None and 0 < high.value < _FULL:
            job.put((*path, "max_power"), high, 1 / _FULL)
        kick = defines.number("FAN_KICKSTART_TIME")
        if kick is not None and kick.value > 0:
            job.put((*path, "kick_start_s"), kick, 1e-3)


def _put_hotend_fan(job: Job, number: int) -> None:
    defines, put, hotend = job.defines, job.draft.put, job.hotends[number]
    pin = job.pins.given(f"E{number}_AUTO_FAN_PIN")
    if pin is None:
        return
    path = ("fans", f"{hotend}_fan")
    put((*path, "pin"), pin, job.place(f"E{number}_AUTO_FAN_PIN"))
    put((*path, "follows"), hotend, None)
    job.put((*path, "above_c"), defines.number("EXTRUDER_AUTO_FAN_TEMPERATURE"))
    speed = defines.number("EXTRUDER_AUTO_FAN_SPEED")
    if speed is not None and speed.value < _FULL:
        job.put((*path, "max_power"), speed, 1 / _FULL)


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
    stays = defines.number(
        "CONTROLLERFAN_IDLE_TIME", "CONTROLLERFAN_SECS", "DURATION_CONTROLLERFAN"
    )
    job.put((*path, "stays_on_s"), stays)


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
