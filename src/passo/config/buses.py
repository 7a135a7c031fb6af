"""Buses of chips: pins, or the name that Klipper's firmware has for a bus."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from passo.config.findings import Finding, table
from passo.config.klippers_firmware import runs_klippers
from passo.config.pin_names import placed, section

SPI_WIRES = ("clock_pin", "mosi_pin", "miso_pin")
I2C_WIRES = ("scl_pin", "sda_pin")
BUS = r"^([A-Za-z0-9_][A-Za-z0-9_-]*:)?[A-Za-z0-9_.]+$"


def check_bus(
    data: Mapping[str, Any], path: tuple[str, ...], part: Mapping[str, Any], key: str
) -> Iterator[Finding]:
    """Checks the pins of the bus of the part at `path`, or the bus itself, which is the value of
    `key`: `spi_bus` or `i2c_bus`."""
    wires = I2C_WIRES if key == "i2c_bus" else SPI_WIRES
    first = "scl_pin" if key == "i2c_bus" else "cs_pin"
    bus = part.get(key)
    if bus is None:
        for pin in dict.fromkeys((first, *wires)):
            if pin not in part:
                yield Finding("config.missing-key", (*path, pin), None, f"a pin, or the key {key}")
        return
    for pin in wires:
        if pin in part:
            limit = f"no such key: {key} has the pins"
            yield Finding("config.conflict", (*path, pin), part[pin], limit)
    owner = table(data, *section(placed(str(part.get(first, bus)))[0]))
    if not runs_klippers(owner):
        limit = f"no such key: Passo's firmware has no buses; give {', '.join(wires)}"
        yield Finding("config.conflict", (*path, key), bus, limit)
