"""A machine whose motors have drivers with registers."""

from __future__ import annotations

from passo import config
from passo.config.load import shipped_text
from passo.config.machine import MachineConfig
from passo.simulator.dictionary import Firmware

# x and y share a UART of one pin, z has one of two pins, e is on an SPI bus.
DRIVERS = """
[steppers.x]
driver = "TMC2209"
steps_per_mm = 80.0
socket = "X"
tmc = { run_current_a = 0.8, hold_current_a = 0.4, stealthchop_below_mm_s = 100, uart_pin = "^D40" }

[steppers.y]
driver = "TMC2209"
steps_per_mm = 80.0
socket = "Y"
tmc = { run_current_a = 0.8, uart_pin = "^D40", address = 1 }

[steppers.z]
driver = "TMC2208"
steps_per_mm = 400.0
socket = "Z"
tmc = { run_current_a = 0.6, uart_pin = "D42", tx_pin = "D44" }

[steppers.e]
driver = "TMC5160"
steps_per_mm = 95.5
socket = "E0"

[steppers.e.tmc]
run_current_a = 1.2
cs_pin = "D23"
clock_pin = "D25"
mosi_pin = "D27"
miso_pin = "D29"
interpolate = false
"""


def machine_text(drivers: str = DRIVERS, firmware: Firmware = "virtual") -> str:
    """The machine file of i3 with these motors."""
    text = shipped_text("i3")
    begin, end = text.index("[steppers.x]"), text.index("[extruders.e]")
    return f'{text[:begin]}{drivers}\n{text[end:]}firmware = "{firmware}"\n'


def machine(drivers: str = DRIVERS, firmware: Firmware = "virtual") -> MachineConfig:
    """That machine."""
    return config.load_text(machine_text(drivers, firmware), "drivers.toml")
