"""Registers of the drivers and the fields in them, by the names of the data sheets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from passo.config.trinamic import ChipName

GCONF, GSTAT, IFCNT, SLAVECONF = 0x00, 0x01, 0x02, 0x03
DRV_CONF, GLOBALSCALER = 0x0A, 0x0B
IHOLD_IRUN, TPOWERDOWN, TPWMTHRS = 0x10, 0x11, 0x13
CHOPCONF, DRV_STATUS, PWMCONF = 0x6C, 0x6F, 0x70

THRESHOLD_MAX = 0xFFFFF  # of TPWMTHRS
CLOCK_HZ = 12_000_000  # of the chips' internal oscillator


class Field(NamedTuple):
    """Adjacent bits of a register; `low` is the lowest bit."""

    low: int
    width: int = 1

    def of(self, register: int) -> int:
        """The field's value in a register."""
        return register >> self.low & (1 << self.width) - 1


_CURRENTS = {"ihold": Field(0, 5), "irun": Field(8, 5), "iholddelay": Field(16, 4)}
_CHOPPER = {
    "toff": Field(0, 4),
    "hstrt": Field(4, 3),
    "hend": Field(7, 4),
    "tbl": Field(15, 2),
    "mres": Field(24, 4),
    "intpol": Field(28),
}
_GSTAT = {"reset": Field(0), "drv_err": Field(1), "uv_cp": Field(2)}
_PWM = {"pwm_freq": Field(16, 2), "pwm_autoscale": Field(18), "pwm_grad": Field(8, 8)}
_NEW_PWM = _PWM | {
    "pwm_ofs": Field(0, 8),
    "pwm_autograd": Field(19),
    "pwm_reg": Field(24, 4),
    "pwm_lim": Field(28, 4),
}
_STATUS_2208 = {
    "otpw": Field(0),
    "ot": Field(1),
    "s2ga": Field(2),
    "s2gb": Field(3),
    "s2vsa": Field(4),
    "s2vsb": Field(5),
    "ola": Field(6),
    "olb": Field(7),
    "cs_actual": Field(16, 5),
    "stealth": Field(30),
    "stst": Field(31),
}
_STATUS_2130 = {
    "cs_actual": Field(16, 5),
    "ot": Field(25),
    "otpw": Field(26),
    "s2ga": Field(27),
    "s2gb": Field(28),
    "ola": Field(29),
    "olb": Field(30),
    "stst": Field(31),
}
_GCONF_2208 = {
    "i_scale_analog": Field(0),
    "internal_rsense": Field(1),
    "en_spreadcycle": Field(2),
    "pdn_disable": Field(6),
    "mstep_reg_select": Field(7),
    "multistep_filt": Field(8),
}


@dataclass(frozen=True, slots=True)
class Chip:
    """One type of chip: the register that contains its `version`, and the fields of each
    register."""

    version_register: int
    version: int
    fields: Mapping[int, Mapping[str, Field]]

    def version_of(self, value: int) -> int:
        """The version in the value of its register."""
        return value >> 24

    def pack(self, register: int, **values: int) -> int:
        """A register's value with these fields, all others 0. Raises KeyError for an unknown field,
        ValueError if a value does not fit its field."""
        packed = 0
        for name, value in values.items():
            field = self.fields[register][name]
            if not 0 <= value < 1 << field.width:
                raise ValueError(f"{name} cannot be {value}")
            packed |= value << field.low
        return packed

    def unpack(self, register: int, value: int) -> dict[str, int]:
        """All known fields of a register."""
        return {name: field.of(value) for name, field in self.fields[register].items()}


_TMC2208 = {
    GCONF: _GCONF_2208,
    GSTAT: _GSTAT,
    SLAVECONF: {"senddelay": Field(8, 4)},
    IHOLD_IRUN: _CURRENTS,
    CHOPCONF: _CHOPPER | {"vsense": Field(17)},
    DRV_STATUS: _STATUS_2208,
    PWMCONF: _NEW_PWM,
}

CHIPS: Mapping[ChipName, Chip] = {
    "TMC2208": Chip(0x06, 0x20, _TMC2208),
    "TMC2209": Chip(0x06, 0x21, _TMC2208),
    "TMC2130": Chip(
        0x04,
        0x11,
        {
            GCONF: {"i_scale_analog": Field(0), "en_pwm_mode": Field(2)},
            GSTAT: _GSTAT,
            IHOLD_IRUN: _CURRENTS,
            CHOPCONF: _CHOPPER | {"vsense": Field(17)},
            DRV_STATUS: _STATUS_2130,
            PWMCONF: _PWM | {"pwm_ampl": Field(0, 8)},
        },
    ),
    "TMC5160": Chip(
        0x04,
        0x30,
        {
            GCONF: {"en_pwm_mode": Field(2), "multistep_filt": Field(3)},
            GSTAT: _GSTAT,
            IHOLD_IRUN: _CURRENTS,
            CHOPCONF: _CHOPPER | {"tpfd": Field(20, 4)},
            DRV_STATUS: _STATUS_2130
            | {"s2vsa": Field(12), "s2vsb": Field(13), "stealth": Field(14)},
            PWMCONF: _NEW_PWM,
        },
    ),
}
