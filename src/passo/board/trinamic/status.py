"""Interprets the status that a driver reports as findings with messages."""

from __future__ import annotations

from typing import NamedTuple

from passo.board.trinamic import registers as r
from passo.config.trinamic import ChipName
from passo.errors import Problem


class Reading(NamedTuple):
    """The values of GSTAT and DRV_STATUS of a driver."""

    gstat: int
    status: int


class Finding(NamedTuple):
    """A fault of a driver. If `stops`, its motor does not move correctly any more."""

    problem: Problem
    stops: bool


_COILS = (("a", "A"), ("b", "B"))


def findings(motor: str, chip: ChipName, reading: Reading) -> list[Finding]:
    """All findings of a reading, the most serious first. Without open coils, which the chip cannot
    detect at standstill: see `open_coils`."""
    flags = r.CHIPS[chip].unpack(r.DRV_STATUS, reading.status)
    general = r.CHIPS[chip].unpack(r.GSTAT, reading.gstat)
    found: list[Finding] = []

    def add(code: str, value: str = "", *, stops: bool = True) -> None:
        values = {"axis": motor, "value": value or chip}
        found.append(Finding(Problem(f"driver.{code}", values=values), stops))

    for suffix, coil in _COILS:
        if flags[f"s2g{suffix}"]:
            add("short-to-ground", coil)
        if flags.get(f"s2vs{suffix}"):
            add("short-to-supply", coil)
    if flags["ot"]:
        add("overheated")
    if general["reset"]:
        add("reset")
    if general["uv_cp"]:
        add("undervoltage")
    if general["drv_err"] and not found:
        add("stopped")
    if flags["otpw"] and not flags["ot"]:
        add("hot", stops=False)
    return found


def open_coils(chip: ChipName, reading: Reading) -> list[str]:
    """Findings for coils that read as open. Call it only for a motor that turns slowly; the flags
    are invalid otherwise."""
    flags = r.CHIPS[chip].unpack(r.DRV_STATUS, reading.status)
    return [coil for suffix, coil in _COILS if flags[f"ol{suffix}"]]
