"""Machines whose X homes by the stall detection of its driver."""

from __future__ import annotations

from tests.support.driver_machine import DRIVERS, machine_text

from passo import config
from passo.config.load import shipped_text
from passo.config.machine import MachineConfig
from passo.simulator.dictionary import Firmware

_UART = 'uart_pin = "^D40" }'
SPI = """
[steppers.x]
driver = "{chip}"
steps_per_mm = 80.0
socket = "X"

[steppers.x.tmc]
run_current_a = 0.8
cs_pin = "D40"
clock_pin = "D25"
mosi_pin = "D27"
miso_pin = "D29"
{key} = "^!X_MIN"
"""


def homing(threshold: int, more: str = "", fast: float = 20.0, home: str = "x") -> str:
    """The table of an axis at the lower end of its travel."""
    return (
        f'[homing.{home}]\ndirection = "min"\nposition = 0.0\nfast = {fast}\n'
        f"stall = {{ threshold = {threshold}{more} }}\n\n"
    )


def with_table(text: str, name: str, table: str) -> str:
    """A machine file with another table of this name."""
    begin = text.index(f"[{name}]")
    return text[:begin] + table + text[text.index("\n[", begin) + 1 :]


def silent_text(
    threshold: int = 60, more: str = "", fast: float = 20.0, firmware: Firmware = "virtual"
) -> str:
    """The machine file of an i3 with a TMC2209 at X."""
    drivers = DRIVERS.replace(_UART, _UART.replace(" }", ', diag_pin = "X_MIN" }'), 1)
    text = machine_text(drivers, firmware)
    return with_table(text, "homing.x", homing(threshold, more, fast))


def silent_machine(
    threshold: int = 60, more: str = "", fast: float = 20.0, firmware: Firmware = "virtual"
) -> MachineConfig:
    """That machine."""
    return config.load_text(silent_text(threshold, more, fast, firmware), "stall.toml")


def spi_machine(chip: str, key: str, threshold: int) -> MachineConfig:
    """An i3 with a driver on an SPI bus at X."""
    text = shipped_text("i3")
    begin, end = text.index("[steppers.x]"), text.index("[steppers.y]")
    text = text[:begin] + SPI.format(chip=chip, key=key) + "\n" + text[end:]
    return config.load_text(with_table(text, "homing.x", homing(threshold)), "stall.toml")


def belts_machine(threshold: int = 60) -> MachineConfig:
    """A CoreXY machine whose X and Y home by stalls."""
    text = shipped_text("corexy")
    for motor, pin, end in (("a", "D40", "X_MIN"), ("b", "D42", "Y_MIN")):
        tmc = f'tmc = {{ run_current_a = 0.8, uart_pin = "{pin}", diag_pin = "{end}" }}'
        text = text.replace(f"[steppers.{motor}]", f"[steppers.{motor}]\n{tmc}")
    for home in "xy":
        text = with_table(text, f"homing.{home}", homing(threshold, home=home))
    return config.load_text(text, "belts.toml")
