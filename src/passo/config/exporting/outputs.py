"""Outputs, and sensors that no heater uses, as sections of Klipper."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.exporting.heat import put_shown_sensor
from passo.config.klipper_names import temperature_object

if TYPE_CHECKING:
    from passo.config.exporting.cfg import Cfg
    from passo.config.outputs import Output


def put_outputs(cfg: Cfg) -> None:
    """Converts the outputs, then the sensors. Options of the machine file without an option in
    Klipper are left out silently: they name commands."""
    for name, output in cfg.machine.outputs.items():
        if output.fixed and output.start in (0, 1) and output.pwm == "none":
            pin = cfg.pin(output.pin if output.start else f"!{output.pin}")
            cfg.put(f"static_digital_output {name}", pins=pin)
        else:
            _put_output(cfg, name, output)
    for name in cfg.machine.sensors:
        section = temperature_object(cfg.machine, name)
        if section not in cfg.sections:  # that of a fan has its sensor
            put_shown_sensor(cfg, name, section)


def _put_output(cfg: Cfg, name: str, output: Output) -> None:
    pulsed = output.pwm != "none"
    cfg.put(
        f"output_pin {name}",
        pin=cfg.output(f"{name}-output", output.pin, output.further_pins),
        pwm=pulsed,
        hardware_pwm=True if output.pwm == "hardware" else None,
        cycle_time=1 / output.pwm_hz if pulsed else None,
        value=output.start * output.scale,
        shutdown_value=output.at_halt * output.scale,
        scale=output.scale if output.scale != 1.0 else None,
        maximum_mcu_duration=output.max_on_s or None,
    )
