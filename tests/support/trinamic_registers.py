"""Addresses of registers that most drivers have, and their fields."""

from __future__ import annotations

from passo.config.trinamic import CHIPS, ChipName

GCONF, GSTAT, IFCNT = 0x00, 0x01, 0x02
GLOBALSCALER, IHOLD_IRUN, TPOWERDOWN, TPWMTHRS = 0x0B, 0x10, 0x11, 0x13
CHOPCONF, DRV_STATUS = 0x6C, 0x6F


def fields(chip: ChipName, address: int, value: int) -> dict[str, int]:
    """The fields in the value of a register."""
    registers = CHIPS[chip].registers.values()
    return next(r for r in registers if r.address == address).unpack(value)
