"""What a driver says of itself, as findings with sentences."""

from __future__ import annotations

from typing import NamedTuple

from passo.board.trinamic import registers as r
from passo.config.trinamic import ChipName
from passo.errors import Problem


class Reading(NamedTuple):
    """GSTAT and DRV_STATUS of a driver."""

    gstat: int
    status: int


class Finding(NamedTuple):
    """What is wrong at a driver. `stops`: its motor does not move as it should any more."""

    problem: Problem
    stops: bool


_COILS = (("a", "A"), ("b", "B"))


def findings(motor: str, chip: ChipName, reading: Reading) -> list[Finding]:
    """All that a reading tells, the gravest first; open coils are in `open_coils`, for the chip
    cannot tell them while the motor stands."""
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
    """Coils that look open: true only of a motor that turns slowly."""
    flags = r.CHIPS[chip].unpack(r.DRV_STATUS, reading.status)
    return [coil for suffix, coil in _COILS if flags[f"ol{suffix}"]]
