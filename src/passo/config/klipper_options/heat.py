"""Options of heaters, extruders, their sensors, and fans."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.klipper_options.motion import MOTOR
from passo.config.klipper_options.option import flag, number, same_as, text, whole, words

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.klipper_options.option import Default, Options, Settings, Value

_AMPLIFIERS = ("AD595", "AD597", "AD8494", "AD8495", "AD8496", "AD8497", "PT100 INA826")


def _of_sensor(kind: str, value: Value) -> Default:
    """A default of the heaters whose sensor is of one kind."""

    def found(section: Settings) -> Value | None:
        sensor = str(section.get("sensor_type", ""))
        if sensor in _AMPLIFIERS:
            its = "amplifier"
        elif sensor.startswith("MAX"):
            its = sensor if sensor in ("MAX31856", "MAX31865") else "MAX"
        else:
            its = "resistor"
        return value if its.startswith(kind) else None

    return found


SENSOR: Options = (
    text("sensor_type"),
    text("sensor_pin"),
    number("pullup_resistor", _of_sensor("resistor", 4700.0)),
    number("inline_resistor", _of_sensor("resistor", 0.0)),
    number("adc_voltage", _of_sensor("amplifier", 5.0)),
    number("voltage_offset", _of_sensor("amplifier", 0.0)),
    text("spi_bus"),
    text("spi_software_sclk_pin"),
    text("spi_software_mosi_pin"),
    text("spi_software_miso_pin"),
    whole("spi_speed", _of_sensor("MAX", 4_000_000)),
    text("tc_type", _of_sensor("MAX31856", "K")),
    flag("tc_use_50hz_filter", _of_sensor("MAX31856", value=False)),
    whole("tc_averaging_count", _of_sensor("MAX31856", 1)),
    number("rtd_nominal_r", _of_sensor("MAX31865", 100.0)),
    number("rtd_reference_r", _of_sensor("MAX31865", 430.0)),
    whole("rtd_num_of_wires", _of_sensor("MAX31865", 2)),
    flag("rtd_use_50hz_filter", _of_sensor("MAX31865", value=False)),
    text("i2c_mcu"),
    text("i2c_bus"),
    text("i2c_software_scl_pin"),
    text("i2c_software_sda_pin"),
    whole("i2c_address"),
    whole("i2c_speed"),
)
_HEATER: Options = (
    *SENSOR,
    text("heater_pin"),
    number("max_power", 1.0),
    number("min_temp"),
    number("max_temp"),
    number("min_extrude_temp", 170.0),
    number("smooth_time", 1.0),
    text("control"),
    number("pid_kp"),
    number("pid_ki"),
    number("pid_kd"),
    number("max_delta", lambda section: 2.0 if section.get("control") == "watermark" else None),
    number("pwm_cycle_time", 0.1),
)
_FILAMENT: Options = (
    number("nozzle_diameter"),
    number("filament_diameter"),
    number("max_extrude_cross_section", lambda section: _cross_section_mm2(section)),
    number("max_extrude_only_distance", 50.0),
    number("max_extrude_only_velocity"),
    number("max_extrude_only_accel"),
    number("instantaneous_corner_velocity", 1.0),
    number("pressure_advance", 0.0),
    number("pressure_advance_smooth_time", 0.04),
)


def _cross_section_mm2(section: Settings) -> float | None:
    """Four times the square of the nozzle."""
    nozzle = section.get("nozzle_diameter")
    return 4 * nozzle**2 if isinstance(nozzle, float) else None


def _fan(kick_start_s: float = 0.1, off: float = 0.0) -> Options:
    """The options of all fans, with the speed that a fan has while the printer is halted."""
    return (
        text("pin"),
        number("max_power", 1.0),
        number("shutdown_speed", off),
        number("cycle_time", 0.01),
        flag("hardware_pwm", default=False),
        number("kick_start_time", kick_start_s),
        number("off_below", 0.0),
        text("enable_pin"),
        text("tachometer_pin"),
        whole("tachometer_ppr", lambda section: 2 if "tachometer_pin" in section else None),
        number(
            "tachometer_poll_interval",
            lambda section: 0.0015 if "tachometer_pin" in section else None,
        ),
    )


HEAT: Mapping[str, Options] = {
    "extruder": (*MOTOR, *_HEATER, *_FILAMENT),
    "heater_bed": _HEATER,
    "heater_generic": (*_HEATER, text("gcode_id")),
    "verify_heater": (
        number("max_error", 120.0),
        number("check_gain_time", 20.0),
        number("hysteresis", 5.0),
        number("heating_gain", 2.0),
    ),
    "thermistor": (number("temperature#"), number("resistance#"), number("beta")),
    "fan": _fan(),
    "heater_fan": (
        *_fan(off=1.0),
        words("heater", ("extruder",)),
        number("heater_temp", 50.0),
        number("fan_speed", 1.0),
    ),
    "controller_fan": (
        *_fan(),
        words("stepper"),
        words("heater", ("extruder",)),
        number("fan_speed", 1.0),
        number("idle_speed", same_as("fan_speed")),
        whole("idle_timeout", 30),
    ),
    "fan_generic": _fan(),
    "temperature_fan": (
        *_fan(off=1.0),
        *SENSOR,
        number("min_temp"),
        number("max_temp"),
        number("target_temp", 40.0),
        number("min_speed", 0.3),
        number("max_speed", 1.0),
        text("control"),
        number("max_delta", lambda section: 2.0 if section.get("control") == "watermark" else None),
        number("pid_kp"),
        number("pid_ki"),
        number("pid_kd"),
        number("pid_deriv_time"),
        text("sensor_mcu"),
        text("gcode_id"),
    ),
}
