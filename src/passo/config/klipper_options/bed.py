"""Options of probes, meshes, screws and the motors of Z."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.klipper_options.option import (
    flag,
    number,
    numbers,
    points,
    same_as,
    text,
    whole,
    whole_numbers,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.klipper_options.option import Options

_PROBE: Options = (
    number("x_offset", 0.0),
    number("y_offset", 0.0),
    number("z_offset"),
    number("speed", 5.0),
    number("lift_speed", same_as("speed")),
    whole("samples", 1),
    number("sample_retract_dist", 2.0),
    text("samples_result", "average"),
    number("samples_tolerance", 0.1),
    whole("samples_tolerance_retries", 0),
)
_TRAVEL: Options = (number("speed", 50.0), number("horizontal_move_z", 5.0))
_RETRIES: Options = (whole("retries", 0), number("retry_tolerance", 0.0))

BED: Mapping[str, Options] = {
    "probe": (
        text("pin"),
        *_PROBE,
        flag("deactivate_on_each_sample", default=True),
        text("activate_gcode", ""),
        text("deactivate_gcode", ""),
    ),
    "bltouch": (
        text("sensor_pin"),
        text("control_pin"),
        *_PROBE,
        number("pin_move_time", 0.68),
        flag("stow_on_each_sample", default=True),
        flag("probe_with_touch_mode", default=False),
        flag("pin_up_reports_not_triggered", default=True),
        flag("pin_up_touch_mode_reports_triggered", default=True),
        text("set_output_mode"),
    ),
    "probe_eddy_current": (
        text("sensor_type"),
        text("intb_pin"),
        text("i2c_mcu"),
        text("i2c_bus"),
        whole("reg_drive_current", 15),
        number("descend_z"),
        *_PROBE,
        text("calibrate"),
    ),
    "safe_z_home": (
        numbers("home_xy_position"),
        number("speed", 50.0),
        number("z_hop", 0.0),
        number("z_hop_speed", 15.0),
        flag("move_to_previous", default=False),
    ),
    "bed_mesh": (
        *_TRAVEL,
        numbers("mesh_min"),
        numbers("mesh_max"),
        number("mesh_radius"),
        numbers("mesh_origin", lambda section: (0.0, 0.0) if "mesh_radius" in section else None),
        whole_numbers("probe_count", lambda section: None if "mesh_radius" in section else (3, 3)),
        whole("round_probe_count", lambda section: 5 if "mesh_radius" in section else None),
        number("fade_start", 1.0),
        number("fade_end", 0.0),
        number("fade_target"),
        number("split_delta_z", 0.025),
        number("move_check_distance", 5.0),
        whole_numbers("mesh_pps", (2, 2)),
        text("algorithm", "lagrange"),
        number("bicubic_tension", 0.2),
        number("adaptive_margin", 0.0),
        whole("scan_overshoot", 0),
        numbers("zero_reference_position"),
        numbers("faulty_region_#_min"),
        numbers("faulty_region_#_max"),
    ),
    "z_tilt": (points("z_positions"), points("points"), *_TRAVEL, *_RETRIES),
    "quad_gantry_level": (
        points("gantry_corners"),
        points("points"),
        *_TRAVEL,
        *_RETRIES,
        number("max_adjust", 4),
    ),
    "screws_tilt_adjust": (
        numbers("screw#"),
        text("screw#_name"),
        *_TRAVEL,
        text("screw_thread", "CW-M3"),
    ),
    "bed_screws": (
        numbers("screw#"),
        text("screw#_name"),
        numbers("screw#_fine_adjust"),
        *_TRAVEL,
        number("probe_height", 0.0),
        number("probe_speed", 5.0),
    ),
}
