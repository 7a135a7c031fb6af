"""Interprets the status that a driver reports as findings with messages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from passo.config.trinamic import CHIPS, ChipName
from passo.errors import Problem

_OFFSET_C, _PER_C = 2038, 7.7  # ADC_TEMP of a TMC2240
_SUPPLY_V = 0.009732  # of a count of its ADC_VSUPPLY


@dataclass(frozen=True, slots=True)
class Reading:
    """What a driver has reported: the value of GSTAT, that of the register with the driver's flags,
    and the fields of further registers."""

    gstat: int
    status: int
    fields: Mapping[str, int] = field(default_factory=dict[str, int])

    def flags(self, chip: ChipName) -> dict[str, int]:
        """The fields of the status register that are not 0."""
        return {n: v for n, v in CHIPS[chip].status.unpack(self.status).items() if v}

    @property
    def temperature_c(self) -> float | None:
        """The temperature of a chip that measures it."""
        raw = self.fields.get("adc_temp")
        return None if raw is None else (raw - _OFFSET_C) / _PER_C

    @property
    def supply_v(self) -> float | None:
        """The voltage of the motor supply, of a chip that measures it."""
        raw = self.fields.get("adc_vsupply")
        return None if raw is None else raw * _SUPPLY_V


class Finding(NamedTuple):
    """A fault of a driver. If `stops`, its motor does not move correctly any more."""

    problem: Problem
    stops: bool


_COILS = (("a", "A"), ("b", "B"))


def findings(motor: str, chip: ChipName, reading: Reading) -> list[Finding]:
    """All findings of a reading, the most serious first. Without open coils, which the chip cannot
    detect at standstill: see `open_coils`."""
    flags = reading.flags(chip)
    gstat = CHIPS[chip].registers.get("GSTAT")
    general = gstat.unpack(reading.gstat) if gstat else {}
    found: list[Finding] = []

    def add(code: str, value: str = "", *, stops: bool = True) -> None:
        values = {"axis": motor, "value": value or chip}
        found.append(Finding(Problem(f"driver.{code}", values=values), stops))

    for suffix, coil in _COILS:
        if flags.get(f"s2g{suffix}"):
            add("short-to-ground", coil)
        if flags.get(f"s2vs{suffix}"):
            add("short-to-supply", coil)
    if flags.get("ot"):
        add("overheated")
    if general.get("reset") or general.get("register_reset"):
        add("reset")
    if general.get("uv_cp") or general.get("vm_uvlo"):
        add("undervoltage")
    if general.get("drv_err") and not found:
        add("stopped")
    if flags.get("otpw") and not flags.get("ot"):
        add("hot", stops=False)
    return found


def names_fault(chip: ChipName, status: int) -> bool:
    """Whether the status register contains a flag of a fault that stops the driver."""
    return any(finding.stops for finding in findings("", chip, Reading(0, status)))


def open_coils(chip: ChipName, reading: Reading) -> list[str]:
    """The coils that read as open. A chip cannot detect them at standstill; at high speed the flags
    are not reliable."""
    flags = reading.flags(chip)
    if flags.get("stst"):
        return []
    return [coil for suffix, coil in _COILS if flags.get(f"ol{suffix}")]
