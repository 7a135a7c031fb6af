"""Filament sensors and buttons as sections of a printer.cfg."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.filament_width import FULL_SCALE
from passo.config.klipper_names import extruder_object, sensor_object

if TYPE_CHECKING:
    from passo.config.exporting.cfg import Cfg
    from passo.config.filament_width import FilamentWidth
    from passo.config.inputs import Button, FilamentSensor

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
        if sensor.width is not None:
            _put_width(cfg, name, sensor, sensor.width)
            continue
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


def _put_width(cfg: Cfg, name: str, sensor: FilamentSensor, width: FilamentWidth) -> None:
    (raw_1, raw_2), (mm_1, mm_2) = width.readings, width.diameters_mm
    common = {
        "default_nominal_filament_diameter": width.nominal_mm,
        "measurement_delay": width.distance_mm,
        "max_difference": width.max_difference_mm,
    }
    section = sensor_object(cfg.machine, name)
    if width.second_pin is None:
        cfg.put(section, pin=cfg.pin(sensor.pin), **common)
        if (raw_1, mm_1) != (0, 0) or raw_2 * 5 != mm_2 * FULL_SCALE:
            cfg.left_out.append(f"filament_sensors.{name}.width.readings: full scale is 5 mm")
        return
    cfg.put(
        section,
        adc1=cfg.pin(sensor.pin),
        adc2=cfg.pin(width.second_pin),
        **common,
        measurement_interval=round(width.interval_mm),
        cal_dia1=mm_1,
        cal_dia2=mm_2,
        raw_dia1=round(raw_1),
        raw_dia2=round(raw_2),
        min_diameter=width.min_mm,
        max_diameter=width.max_mm,
        enable=width.measures,
        enable_flow_compensation=width.corrects_flow,
        use_current_dia_while_delay=width.corrects_at_once,
        logging=width.logs,
        pause_on_runout=sensor.on_runout == "pause",
        runout_gcode=_gcode(sensor.runout_gcode),
        insert_gcode=_gcode(sensor.insert_gcode),
        event_delay=sensor.event_delay_s,
    )


def _range(button: Button) -> str | None:
    ohm = button.resistance_ohm
    return f"{ohm[0]:g}, {ohm[1]:g}" if ohm else None


def _gcode(text: str) -> str | None:
    return "\n" + text.strip() if text.strip() else None
