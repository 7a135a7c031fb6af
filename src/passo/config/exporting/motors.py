"""Motors with their drivers as sections of Klipper."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.klipper_names import driver_object
from passo.config.pin_names import placed
from passo.config.trinamic import chip_of

if TYPE_CHECKING:
    from passo.config.exporting.cfg import Cfg

_FULL_TURN = 200


def put_stepper(cfg: Cfg, name: str, section: str) -> None:
    """Writes the pins, the scale and the driver of a motor."""
    stepper, machine = cfg.machine.steppers[name], cfg.machine
    step, direction, enable = _pins(cfg, name)
    cfg.motors[name] = section
    full = stepper.full_steps_per_rotation
    distance = full * stepper.microsteps / stepper.steps_per_unit
    cfg.put(
        section,
        step_pin=cfg.pin(step),
        dir_pin=_toggled(cfg.pin(direction)) if stepper.invert else cfg.pin(direction),
        enable_pin=cfg.pin(enable) if enable else None,
        microsteps=stepper.microsteps,
        full_steps_per_rotation=full if full != _FULL_TURN else None,
        rotation_distance=distance,
        step_pulse_duration=stepper.pulse_us * 1e-6 if stepper.pulse_us else None,
    )
    tmc, chip = stepper.tmc, chip_of(stepper.driver)
    if tmc is None or chip is None:
        return
    driver = driver_object(chip, section)
    socket = machine.socket(name)
    select = tmc.cs_pin or (f"{stepper.socket}_SELECT" if socket and socket.select else None)
    buses = (tmc.clock_pin, tmc.mosi_pin, tmc.miso_pin)
    clock, mosi, miso = (cfg.pin(pin) if pin else None for pin in buses)
    cfg.put(
        driver,
        uart_pin=cfg.pin(tmc.uart_pin) if tmc.uart_pin else None,
        tx_pin=cfg.pin(tmc.tx_pin) if tmc.tx_pin else None,
        uart_address=tmc.address or None,
        cs_pin=cfg.pin(select) if select and not tmc.uart_pin else None,
        spi_bus=placed(tmc.spi_bus)[1] if tmc.spi_bus else None,
        spi_software_sclk_pin=clock,
        spi_software_mosi_pin=mosi,
        spi_software_miso_pin=miso,
        run_current=tmc.run_current_a,
        hold_current=tmc.hold_current_a,
        sense_resistor=None if chip == "TMC2240" else tmc.resistor_ohm(chip),
        rref=tmc.resistor_ohm(chip) if chip == "TMC2240" else None,
        stealthchop_threshold=tmc.stealthchop_below_mm_s,
        interpolate=None if tmc.interpolate else False,
    )


def _pins(cfg: Cfg, name: str) -> tuple[str, str, str | None]:
    """The step, direction and enable pins of a motor, with their names in the machine file."""
    stepper = cfg.machine.steppers[name]
    socket = stepper.socket
    step = stepper.step_pin or f"{socket}_STEP"
    direction = stepper.direction_pin or f"{socket}_DIR"
    enable = stepper.enable_pin or (f"{socket}_ENABLE" if socket else None)
    return step, direction, enable


def _toggled(pin: str) -> str:
    """The pin, inverted once more."""
    return pin.replace("!", "") if "!" in pin else f"!{pin}"
