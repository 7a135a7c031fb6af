"""Options of the sections that only add commands: the SD card, pauses, macros."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.klipper_options.option import number, text

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.klipper_options.option import Options

COMMANDS: Mapping[str, Options] = {
    "virtual_sdcard": (text("path"), text("on_error_gcode", "TURN_OFF_HEATERS")),
    "pause_resume": (number("recover_velocity", 50.0),),
    "idle_timeout": (number("timeout", 600.0), text("gcode", "TURN_OFF_HEATERS\nM84")),
    "respond": (text("default_type", "echo"), text("default_prefix", "echo:")),
    "gcode_arcs": (number("resolution", 1.0),),
    "display_status": (),
    "exclude_object": (),
    "firmware_retraction": (
        number("retract_length", 0.0),
        number("retract_speed", 20.0),
        number("unretract_extra_length", 0.0),
        number("unretract_speed", 10.0),
    ),
    "save_variables": (text("filename"),),
    "gcode_macro": (
        text("gcode"),
        text("description", "G-Code macro"),
        text("rename_existing"),
    ),
    "delayed_gcode": (text("gcode"), number("initial_duration", 0.0)),
}
