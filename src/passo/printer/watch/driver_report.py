"""What a driver has reported, as the status and M122 show it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from passo.board.trinamic import findings, open_coils
from passo.errors import Problem
from passo.printer.fault_status import faults_of
from passo.printer.status import DriverStatus

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.board.drivers import DriverState
    from passo.printer.status import Status


def mode_of(state: DriverState) -> str:
    """The mode of a driver below its threshold."""
    return "spreadCycle" if state.settings.threshold is None else "stealthChop"


def problems_of(motor: str, state: DriverState) -> list[Problem]:
    """The faults and warnings of a driver, the most serious first."""
    if state.failure is not None:
        return [state.failure.problem]
    if state.reading is None:
        return []
    chip = state.settings.chip
    open_ = [
        Problem("driver.open-coil", values={"axis": motor, "value": coil})
        for coil in open_coils(chip, state.reading)
    ]
    return [finding.problem for finding in findings(motor, chip, state.reading)] + open_


def status_of(motor: str, state: DriverState) -> DriverStatus:
    """The status of one driver; its flags are at most about a second old."""
    settings, made = state.settings, state.settings.currents
    reading = state.reading if state.failure is None else None
    return DriverStatus(
        settings.chip,
        round(made.run_a, 3),
        round(made.hold_a, 3),
        settings.microsteps,
        mode_of(state),
        None if reading is None else reading.flags(settings.chip),
        None if reading is None else reading.temperature_c,
        None if reading is None else reading.supply_v,
        faults_of(problems_of(motor, state)),
    )


def with_drivers(status: Status, states: Mapping[str, DriverState]) -> Status:
    """The status with that of the drivers."""
    return replace(status, drivers={m: status_of(m, state) for m, state in states.items()})
