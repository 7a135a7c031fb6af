"""Filament sensors and buttons as sections of a printer.cfg."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.klipper_names import extruder_object, sensor_object

if TYPE_CHECKING:
    from passo.config.exporting.cfg import Cfg
    from passo.config.inputs import Button

_ACTIONS = {
    "none": "",
    "pause": "PAUSE",
    "resume": "RESUME",
    "cancel": "CANCEL_PRINT",
    "halt": "M112",
}


def put_inputs(cfg: Cfg) -> None:
    """Writes the filament sensors and the buttons."""
    extruders = list(cfg.machine.extruders)
    for name, sensor in cfg.machine.filament_sensors.items():
        moves = sensor.kind == "motion"
        own = extruders.index(sensor.extruder) if sensor.extruder else 0
        cfg.put(
            sensor_object(cfg.machine, name),
            switch_pin=cfg.pin(sensor.pin),
            pause_on_runout=sensor.on_runout == "pause",
            runout_gcode=_gcode(sensor.runout_gcode),
            insert_gcode=_gcode(sensor.insert_gcode),
            event_delay=sensor.event_delay_s,
            debounce_delay=None if moves else sensor.debounce_s,
            detection_length=sensor.length_mm if moves else None,
            extruder=extruder_object(own) if moves else None,
        )
        lengths = ("delay_mm", "unload_mm", "load_mm")
        cfg.left_out += [
            f"filament_sensors.{name}.{key}: write it in runout_gcode"
            for key in lengths
            if getattr(sensor, key)
        ]
    for name, button in cfg.machine.buttons.items():
        lines = [_ACTIONS[button.action], button.press_gcode]
        cfg.put(
            f"gcode_button {name}",
            pin=cfg.pin(button.pin),
            analog_range=_range(button),
            analog_pullup_resistor=button.pull_up_ohm if button.resistance_ohm else None,
            press_gcode=_gcode("\n".join(line for line in lines if line)) or "",
            release_gcode=_gcode(button.release_gcode),
            debounce_delay=button.debounce_s,
        )


def _range(button: Button) -> str | None:
    ohm = button.resistance_ohm
    return f"{ohm[0]:g}, {ohm[1]:g}" if ohm else None


def _gcode(text: str) -> str | None:
    return "\n" + text.strip() if text.strip() else None
