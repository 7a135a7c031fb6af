"""Homing by the stall detection of drivers, `tmc2209_stepper_x:virtual_endstop`."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.importing.draft import NO_STALL_PIN, NO_STALLS, NO_THRESHOLD
from passo.config.stalls import STALL_KINDS
from passo.config.trinamic import chip_of

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_STALL = re.compile(r"[!^~]*(tmc\d+)_(\w+)\s*:\s*virtual_endstop")


def by_stall(written: str) -> bool:
    """Whether an endstop_pin names the stall detection of a driver."""
    return _STALL.fullmatch(written) is not None


def put_stall(job: Import, sections: list[Section], names: list[str], path: KeyPath) -> str:
    """Imports the stall detection of an axis or a tower with its pins, thresholds and current.
    Returns why that is not possible, or an empty text. `names` are the motors of the `sections`."""
    put, found = job.draft.put, False
    for section, motor in zip(sections, names, strict=True):
        named = _STALL.fullmatch(section.text("endstop_pin"))
        driver = job.config.get(f"{named[1]} {named[2]}") if named else None
        if driver is None or driver.rest != section.name:
            continue
        chip, tmc = chip_of(driver.kind.upper()), ("steppers", motor, "tmc")
        if chip not in STALL_KINDS or (*tmc, "run_current_a") not in job.draft.keys:
            return NO_STALLS
        kind = STALL_KINDS[chip]
        key = next((key for key in kind.pins if key in driver.options), "")
        pin = job.pins.of(driver, key) if key else None
        if pin is None:
            return NO_STALL_PIN
        put((*tmc, key), pin, driver.at(key))
        option = f"driver_{kind.field}"
        driver.used.update((option, "home_current"))
        if not found:
            found = True
            threshold, place = driver.number(option), driver.at(option)
            tuning = job.config.get(f"autotune_tmc {driver.rest}")
            tuned = "sgt" if kind.field == "sgt" else "sg4_thrs"
            if threshold is None and tuning is not None and tuned in tuning.options:
                threshold, place = tuning.number(tuned), tuning.at(tuned)
            put((*path, "stall", "threshold"), int(threshold or 0), place)
            if threshold is None:
                job.draft.decide(driver.place, f"[{driver.name}] {option}", NO_THRESHOLD)
            current = driver.number("home_current")
            put((*path, "stall", "current_a"), current, driver.at("home_current"))
    return "" if found else NO_STALLS
