"""Options of pins, lights, buttons, and sensors that switch or show something."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.klipper_options.heat import SENSOR
from passo.config.klipper_options.option import flag, number, text, whole, words

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.klipper_options.heat import SENSOR
from passo.config.klipper_options.option import Options

_PIN: Options = (
    text("pin"),
    flag("pwm", default=False),
    number("value", 0.0),
    number("shutdown_value", 0.0),
    number("cycle_time", 0.1),
    flag("hardware_pwm", default=False),
    number("scale"),
    number("maximum_mcu_duration", 0.0),
)
_COLOUR: Options = tuple(
    number(f"initial_{name}", 0.0) for name in ("red", "green", "blue", "white")
)
_CHAIN: Options = (whole("chain_count", 1), *_COLOUR)
_RUNOUT: Options = (
    flag("pause_on_runout", default=True),
    text("runout_gcode", ""),
    text("insert_gcode", ""),
    number("event_delay", 3.0),
    number("pause_delay", 0.5),
)
_FILAMENT: Options = (text("switch_pin"), *_RUNOUT, number("debounce_delay", 0.0))
_WIDTH: Options = (
    number("default_nominal_filament_diameter"),
    number("measurement_delay"),
)

OUTPUTS: Mapping[str, Options] = {
    "output_pin": _PIN,
    "pwm_tool": _PIN,
    "pwm_cycle_time": _PIN,
    "static_digital_output": (words("pins"),),
    "servo": (
        text("pin"),
        number("maximum_servo_angle", 180.0),
        number("minimum_pulse_width", 0.001),
        number("maximum_pulse_width", 0.002),
        number("initial_angle"),
        number("initial_pulse_width"),
    ),
    "neopixel": (text("pin"), *_CHAIN, text("color_order", "GRB")),
    "dotstar": (text("data_pin"), text("clock_pin"), *_CHAIN),
    "led": (
        *(text(f"{name}_pin") for name in ("red", "green", "blue", "white")),
        number("cycle_time", 0.01),
        flag("hardware_pwm", default=False),
        *_COLOUR,
    ),
    "pca9632": (
        whole("i2c_address", 98),
        text("i2c_software_scl_pin"),
        text("i2c_software_sda_pin"),
        text("color_order", "RGBW"),
        *_COLOUR,
    ),
    "pca9533": (
        whole("i2c_address", 98),
        text("i2c_software_scl_pin"),
        text("i2c_software_sda_pin"),
        *_COLOUR,
    ),
    "gcode_button": (
        text("pin"),
        text("analog_range"),
        number("analog_pullup_resistor"),
        text("press_gcode", ""),
        text("release_gcode", ""),
        number("debounce_delay", 0.0),
    ),
    "filament_switch_sensor": _FILAMENT,
    "filament_motion_sensor": (
        *_FILAMENT,
        number("detection_length", 7.0),
        text("extruder"),
    ),
    "hall_filament_width_sensor": (
        text("adc1"),
        text("adc2"),
        *_WIDTH,
        number("max_difference", 0.2),
        whole("measurement_interval", 10),
        *(number("cal_dia1", 1.5), number("cal_dia2", 2.0)),
        *(whole("raw_dia1", 9500), whole("raw_dia2", 10500)),
        number("min_diameter", 1.0),
        number("max_diameter"),
        *(flag("enable", default=False), flag("logging", default=False)),
        flag("enable_flow_compensation", default=True),
        flag("use_current_dia_while_delay", default=False),
        *_RUNOUT,
    ),
    "tsl1401cl_filament_width_sensor": (text("pin"), *_WIDTH, number("max_difference")),
    "temperature_sensor": (
        *SENSOR,
        text("sensor_mcu"),
        text("sensor_path"),
        number("min_temp", -273.15),
        number("max_temp", 99999999.9),
        text("gcode_id"),
    ),
}
