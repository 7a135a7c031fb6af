"""Heaters, their sensors and fans as sections of Klipper."""

from __future__ import annotations

from math import exp, log
from typing import TYPE_CHECKING, Any

from passo.config.i2c_sensors import FAMILIES, I2cSensor
from passo.config.klipper_names import fan_object, heater_object, temperature_object
from passo.config.pin_names import placed
from passo.config.sensors import (
    Converter,
    Platinum,
    PlatinumAmplifier,
    Thermistor,
    ThermocoupleAmplifier,
)
from passo.config.shown_sensors import ChipSensor, CombinedSensor, HostSensor
from passo.config.thermistor import ZERO_C

if TYPE_CHECKING:
    from passo.config.electronics import Tachometer, Thermostat
    from passo.config.exporting.cfg import Cfg
    from passo.config.heat import Heater
    from passo.config.sensors import AnySensor

_POINTS_C = (25.0, 150.0, 250.0)
_WATERMARK_C = 2.0


def put_heat(cfg: Cfg) -> None:
    """Converts all heaters, then all fans. A hotend without an extruder of its own is a
    [heater_generic], because Klipper's extruder has a motor and a heater."""
    names: dict[str, str] = {}
    for name, heater in cfg.machine.heaters.items():
        named = heater_object(cfg.machine, name)
        if heater.kind == "hotend" and cfg.machine.extruders and named not in cfg.sections:
            named = f"heater_generic {name}"
        names[name] = named
        _put_heater(cfg, name, heater, named)
    _put_fans(cfg, names)


def _put_heater(cfg: Cfg, name: str, heater: Heater, section: str) -> None:
    cfg.put(
        section,
        heater_pin=cfg.output(name, heater.pin, heater.further_pins),
        sensor_pin=cfg.pin(heater.sensor_pin),
    )
    put_sensor(cfg, "heaters", name, heater.sensor, section)
    control: Any = heater.control
    gains = [getattr(control, gain, None) for gain in ("kp", "ki", "kd")]
    if control.kind == "pid" and None not in gains:
        kp, ki, kd = gains
        cfg.put(section, control="pid", pid_Kp=kp, pid_Ki=ki, pid_Kd=kd)
    else:
        band = control.hysteresis_c if control.kind == "bang-bang" else _WATERMARK_C
        cfg.put(section, control="watermark", max_delta=max(band, 0.1))
        if control.kind != "bang-bang":
            cfg.left_out.append(f"heaters.{name}.control: find its gains with PID_CALIBRATE")
    power = heater.max_power if heater.max_power < 1 else None
    cfg.put(section, min_temp=heater.min_c, max_temp=heater.max_c, max_power=power)
    cfg.put(section, pwm_cycle_time=1 / heater.pwm_hz)
    protection = heater.protection
    if protection.watch_rise_c > 0 and protection.runaway_c > 0:
        cfg.put(
            f"verify_heater {section.removeprefix('heater_generic ')}",
            check_gain_time=heater.watch_s,
            heating_gain=protection.watch_rise_c,
            hysteresis=protection.runaway_c,
        )
    else:
        cfg.left_out.append(f"heaters.{name}.protection: Klipper's own protection is on")


def put_sensor(cfg: Cfg, part: str, name: str, sensor: AnySensor, section: str) -> None:
    """Writes the sensor of the part `name` in the table `part` of the machine file."""
    kind = sensor.kind.upper()
    if isinstance(sensor, Thermistor):
        _put_thermistor(cfg, name, sensor)
        cfg.put(section, sensor_type=f"thermistor_{name}", pullup_resistor=sensor.pullup_ohm)
    elif isinstance(sensor, Platinum):
        cfg.put(section, sensor_type=kind, pullup_resistor=sensor.pullup_ohm)
    elif isinstance(sensor, PlatinumAmplifier) and sensor.kind == "pt100-amplifier":
        cfg.put(section, sensor_type="PT100 INA826", adc_voltage=sensor.full_scale_v)
    elif isinstance(sensor, Converter):
        cfg.put(
            section,
            sensor_type=kind,
            spi_software_sclk_pin=cfg.pin(sensor.clock_pin),
            spi_software_miso_pin=cfg.pin(sensor.miso_pin),
            spi_software_mosi_pin=cfg.pin(sensor.mosi_pin),
        )
    elif isinstance(sensor, ThermocoupleAmplifier):
        cfg.put(section, sensor_type=kind, adc_voltage=sensor.full_scale_v)
    else:
        cfg.left_out.append(f"{part}.{name}.sensor: give sensor_type of [{section}] by hand")


def _put_thermistor(cfg: Cfg, name: str, sensor: Thermistor) -> None:
    """Writes β, or three points of 1/T = A + ln R / β + C·(ln R)³, from which Klipper calculates A,
    β and C."""
    section = f"thermistor thermistor_{name}"
    if sensor.c_per_k == 0:
        cfg.put(section, temperature1=25.0, resistance1=sensor.r25_ohm, beta=sensor.beta_k)
        return
    for number, celsius in enumerate(_POINTS_C, 1):
        ohm = _ohm(sensor, celsius)
        cfg.put(section, **{f"temperature{number}": celsius, f"resistance{number}": ohm})


def _ohm(sensor: Thermistor, celsius: float) -> float:
    """The resistance at a temperature, by Newton's method on ln R."""
    b, c, log_r25 = 1 / sensor.beta_k, sensor.c_per_k, log(sensor.r25_ohm)
    a = 1 / (25 + ZERO_C) - b * log_r25 - c * log_r25**3
    x = log_r25
    for _ in range(50):
        x -= (a + b * x + c * x**3 - 1 / (celsius + ZERO_C)) / (b + 3 * c * x**2)
    return exp(x)


def put_shown_sensor(cfg: Cfg, name: str, section: str) -> None:
    """Writes a sensor without a heater into a section."""
    shown = cfg.machine.sensors[name]
    sensor = shown.sensor
    if isinstance(sensor, HostSensor):
        cfg.put(section, sensor_type="temperature_host")
    elif isinstance(sensor, CombinedSensor):
        machine = cfg.machine
        names = [
            heater_object(machine, one)
            if one in machine.heaters
            else temperature_object(machine, one)
            for one in sensor.of
        ]
        cfg.put(section, sensor_type="temperature_combined", sensor_list=", ".join(names))
        cfg.put(
            section, combination_method=sensor.by, maximum_deviation=sensor.max_deviation_c or 999.9
        )
    elif isinstance(sensor, ChipSensor):
        cfg.put(section, sensor_type="temperature_mcu", sensor_mcu=sensor.board or None)
    elif isinstance(sensor, I2cSensor):
        _put_i2c_sensor(cfg, section, sensor)
    else:
        cfg.put(section, sensor_pin=cfg.pin(shown.sensor_pin) if shown.sensor_pin else None)
        put_sensor(cfg, "sensors", name, sensor, section)
    set_ = shown.model_fields_set
    low, high = (getattr(shown, key) if key in set_ else None for key in ("min_c", "max_c"))
    cfg.put(section, min_temp=low, max_temp=high, gcode_id=shown.letter)


def _put_i2c_sensor(cfg: Cfg, section: str, sensor: I2cSensor) -> None:
    """Klipper's name for all chips of Bosch is BME280."""
    family = FAMILIES[sensor.kind]
    kind = family.name if family.name == "bme280" else sensor.kind
    scl, sda = (cfg.pin(pin) if pin else None for pin in (sensor.scl_pin, sensor.sda_pin))
    cfg.put(
        section,
        sensor_type=kind.upper(),
        i2c_address=sensor.used_address,
        i2c_mcu=sensor.written_board or None,
        i2c_bus=placed(sensor.i2c_bus)[1] if sensor.i2c_bus else None,
        i2c_software_scl_pin=scl,
        i2c_software_sda_pin=sda,
        i2c_speed=sensor.i2c_hz,
    )
    if family.report_option:
        cfg.put(section, **{family.report_option: sensor.period_s})


def _put_tachometer(cfg: Cfg, section: str, tachometer: Tachometer) -> None:
    cfg.put(
        section,
        tachometer_pin=cfg.pin(tachometer.pin),
        tachometer_ppr=tachometer.pulses,
        tachometer_poll_interval=tachometer.poll_ms / 1000,
    )


def _put_thermostat(cfg: Cfg, section: str, kept: Thermostat) -> None:
    put_shown_sensor(cfg, kept.sensor, section)
    shown = cfg.machine.sensors[kept.sensor]
    cfg.put(section, min_temp=max(shown.min_c, -ZERO_C), max_temp=shown.max_c)  # needed for a fan
    cfg.put(section, target_temp=kept.target_c, min_speed=kept.min_power)
    if kept.kp is None:
        cfg.put(section, control="watermark", max_delta=kept.hysteresis_c)
    else:
        cfg.put(section, control="pid", pid_Kp=kept.kp, pid_Ki=kept.ki, pid_Kd=kept.kd)


def _plain(heater: str) -> str:
    """The name of a heater in a list of heaters."""
    return heater.removeprefix("heater_generic ")


def _put_fans(cfg: Cfg, heaters: dict[str, str]) -> None:
    for name, fan in cfg.machine.fans.items():
        section = fan_object(cfg.machine, name)
        moved = fan.follows_motors
        if fan.warmed_by:
            followed = ", ".join(_plain(heaters[one]) for one in fan.warmed_by)
            cfg.put(section, heater=followed, heater_temp=fan.above_c)
        elif (kept := fan.thermostat) is not None:
            _put_thermostat(cfg, section, kept)
        elif moved or fan.follows_targets:
            named = (_plain(heaters[one]) for one in fan.follows_targets)
            cfg.put(section, heater=", ".join(named) or None, idle_speed=fan.idle_power)
            own = ", ".join(cfg.motors[motor] for motor in moved if motor in cfg.motors)
            cfg.put(section, stepper=own, idle_timeout=int(fan.stays_on_s))
        if fan.tachometer is not None:
            _put_tachometer(cfg, section, fan.tachometer)
        cfg.put(
            section,
            pin=cfg.output(f"{name}-fan", fan.pin, fan.further_pins),
            max_power=fan.max_power if fan.max_power < 1 else None,
            off_below=fan.off_below or None,
            kick_start_time=fan.kick_start_s if section == "fan" else None,
            cycle_time=1 / fan.pwm_hz,
        )
        if fan.min_power:
            cfg.left_out.append(f"fans.{name}.min_power: set off_below of [{section}] by hand")
