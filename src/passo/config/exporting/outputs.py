"""Outputs, and sensors that no heater uses, as sections of Klipper."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.exporting.heat import put_shown_sensor
from passo.config.klipper_names import light_object, temperature_object
from passo.config.lights import LIGHT_PINS, Dotstar, Led, LedChip, Neopixel, start_color

if TYPE_CHECKING:
    from passo.config.exporting.cfg import Cfg
    from passo.config.lights import Framed
    from passo.config.outputs import Output

_I2C_PINS = {"scl_pin": "i2c_software_scl_pin", "sda_pin": "i2c_software_sda_pin"}


def put_outputs(cfg: Cfg) -> None:
    """Converts the outputs, then the sensors. Options of the machine file without an option in
    Klipper are left out silently: they name commands."""
    for name, output in cfg.machine.outputs.items():
        if output.fixed and output.start in (0, 1) and output.pwm == "none":
            pin = cfg.pin(output.pin if output.start else f"!{output.pin}")
            cfg.put(f"static_digital_output {name}", pins=pin)
        else:
            _put_output(cfg, name, output)
    for name, servo in cfg.machine.servos.items():
        cfg.put(
            f"servo {name}",
            pin=cfg.pin(servo.pin),
            minimum_pulse_width=servo.min_pulse_us / 1e6,
            maximum_pulse_width=servo.max_pulse_us / 1e6,
            maximum_servo_angle=servo.max_deg,
            initial_angle=servo.start_deg,
        )
    for name, light in cfg.machine.lights.items():
        _put_light(cfg, name, light)
    for name in cfg.machine.sensors:
        section = temperature_object(cfg.machine, name)
        if section not in cfg.sections:  # that of a fan has its sensor
            put_shown_sensor(cfg, name, section)


def _put_light(cfg: Cfg, name: str, light: Framed | Led) -> None:
    section = light_object(cfg.machine, name)
    for key in LIGHT_PINS:
        if pin := getattr(light, key, None):
            cfg.put(section, **{_I2C_PINS.get(key, key): cfg.pin(pin)})
    if isinstance(light, Neopixel | Dotstar):
        cfg.put(section, chain_count=light.count)
    if isinstance(light, Neopixel):
        cfg.put(section, color_order=", ".join(light.orders) or light.order)
    if isinstance(light, LedChip) and light.kind == "pca9632":
        cfg.put(section, color_order=light.order)
    if isinstance(light, LedChip):
        cfg.put(section, i2c_address=light.address)
    if isinstance(light, Led):
        hardware = True if light.pwm == "hardware" else None
        cfg.put(section, cycle_time=1 / light.pwm_hz, hardware_pwm=hardware)
    for color, share in zip(("RED", "GREEN", "BLUE", "WHITE"), start_color(light), strict=True):
        if share:
            cfg.put(section, **{f"initial_{color}": share})


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
