"""Options of boards, limits, motors, shapers and accelerometers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.klipper_options.option import (
    flag,
    number,
    points,
    ratios,
    same_as,
    text,
    whole,
    words,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from passo.config.klipper_options.option import Options, Settings, Value

MOTOR: Options = (
    text("step_pin"),
    text("dir_pin"),
    text("enable_pin"),
    number("rotation_distance"),
    whole("microsteps"),
    whole("full_steps_per_rotation", 200),
    ratios("gear_ratio", ()),
    number("step_pulse_duration"),
)


def _of_rail(name: str, factor: float | None = None) -> Callable[[Settings], Value | None]:
    """A default of the motors that home; a second motor of an axis has none of these options."""

    def found(section: Settings) -> Value | None:
        if "position_endstop" not in section and "position_max" not in section:
            return None
        return same_as(name, factor)(section)

    return found


def _homes_up(section: Settings) -> bool | None:
    """Whether an axis homes to its end, by the half of the range that has the endstop."""
    end, first, last = (
        section.get(key) for key in ("position_endstop", "position_min", "position_max")
    )
    if not isinstance(end, float):
        return None
    if not isinstance(last, float) or not isinstance(first, float):
        return "arm_length" in section or None
    return end > (first + last) / 2


_SPI: Options = (
    text("cs_pin"),
    text("spi_bus"),
    text("spi_software_sclk_pin"),
    text("spi_software_mosi_pin"),
    text("spi_software_miso_pin"),
    whole("spi_speed", lambda section: 5_000_000 if "cs_pin" in section else None),
)

MOTION: Mapping[str, Options] = {
    "mcu": (text("serial"), whole("baud", 250_000), text("restart_method")),
    "printer": (
        text("kinematics"),
        number("max_velocity"),
        number("max_accel"),
        number("max_z_velocity", same_as("max_velocity")),
        number("max_z_accel", same_as("max_accel")),
        number("minimum_cruise_ratio", 0.5),
        number("max_accel_to_decel", lambda section: _accel_to_decel(section)),  # until 2024
        number("square_corner_velocity", 5.0),
        number("delta_radius"),
        number("print_radius", same_as("delta_radius")),
        number("minimum_z_position", lambda section: 0 if "delta_radius" in section else None),
    ),
    "stepper": (
        *MOTOR,
        text("endstop_pin"),
        number("position_endstop"),
        number("position_max"),
        number("position_min", lambda section: 0.0 if "position_max" in section else None),
        number("arm_length"),
        number("angle"),
        number("homing_speed", lambda section: 5.0 if "position_endstop" in section else None),
        number("second_homing_speed", _of_rail("homing_speed", 0.5)),
        number("homing_retract_speed", _of_rail("homing_speed")),
        number("homing_retract_dist", lambda s: 5.0 if "position_endstop" in s else None),
        flag("homing_positive_dir", _homes_up),
    ),
    "input_shaper": (
        text("shaper_type", "mzv"),
        *(text(f"shaper_type_{axis}", same_as("shaper_type")) for axis in "xyz"),
        *(number(f"shaper_freq_{axis}", 0.0) for axis in "xyz"),
        *(number(f"damping_ratio_{axis}", 0.1) for axis in "xyz"),
    ),
    "adxl345": (
        *_SPI,
        words("axes_map", ("x", "y", "z")),
        whole("rate", 3200),
    ),
    "lis2dw": (
        *_SPI,
        words("axes_map", ("x", "y", "z")),
        text("i2c_mcu", lambda section: None if "cs_pin" in section else "mcu"),
        text("i2c_bus"),
        text("i2c_software_scl_pin"),
        text("i2c_software_sda_pin"),
        whole("i2c_address", lambda section: None if "cs_pin" in section else 25),
        whole("i2c_speed", lambda section: None if "cs_pin" in section else 400_000),
    ),
    "resonance_tester": (
        text("accel_chip"),
        text("accel_chip_x"),
        text("accel_chip_y"),
        text("accel_chip_z", ""),
        points("probe_points"),
        number("min_freq", 5.0),
        number("max_freq", 135.0),
        number("max_freq_z", 100.0),
        number("accel_per_hz", 60.0),
        number("accel_per_hz_z", 15.0),
        number("hz_per_sec", 1.0),
        number("sweeping_accel", 400.0),
        number("sweeping_accel_z", 50.0),
        number("sweeping_period", 1.2),
        number("move_speed", 50.0),
        number("max_smoothing"),
    ),
    "force_move": (flag("enable_force_move", default=False),),
    "skew_correction": (),
}


def _accel_to_decel(printer: Settings) -> float | None:
    """The limit that minimum_cruise_ratio has replaced: old macros read it."""
    accel, ratio = printer.get("max_accel"), printer.get("minimum_cruise_ratio")
    return accel * (1 - ratio) if isinstance(accel, float) and isinstance(ratio, float) else None
