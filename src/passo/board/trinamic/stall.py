"""The settings with which a driver detects the stall of its motor."""

from __future__ import annotations

from dataclasses import replace

from passo.board.trinamic.settings import DriverSettings, threshold_of
from passo.config.stalls import STALL_KINDS

# A driver measures no load below this fraction of the speed of homing: while the motor accelerates,
# the load value is low.
_LEAST_SPEED = 0.8


def stall_threshold(settings: DriverSettings) -> int:
    """The threshold of a driver: SGTHRS or SGT."""
    return settings.fields.get(STALL_KINDS[settings.chip].field, 0)


def stall_settings(
    settings: DriverSettings, threshold: int, microsteps_s: float, current_a: float | None, pin: str
) -> DriverSettings:
    """The settings of a driver that shows at the `pin` diag_pin, diag0_pin or diag1_pin when its
    motor stalls, if it makes about `microsteps_s`. The hold current keeps its ratio to the run
    current."""
    kind = STALL_KINDS[settings.chip]
    window = threshold_of(settings.chip, microsteps_s * _LEAST_SPEED, settings.microsteps)
    fields = {**settings.fields, kind.field: threshold, "tcoolthrs": window}
    if not kind.silent:
        fields |= {"thigh": 0, f"{pin.removesuffix('_pin')}_stall": 1}
    run_a = settings.run_a if current_a is None else current_a
    return replace(
        settings,
        run_a=run_a,
        hold_a=settings.hold_a / settings.run_a * run_a,
        threshold=0 if kind.silent else None,
        fields=fields,
    )
