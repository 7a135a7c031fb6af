"""From amperes to the numbers in a driver's registers, and back."""

from __future__ import annotations

from typing import NamedTuple

from passo.config.trinamic import CHIPS, ChipName, full_scale_a

_STEPS = 32  # values of IRUN and IHOLD: 0 is 1/32 of full scale
_SCALER_FULL = 256
_SCALER_MIN = 32  # the data sheet of the TMC5160 does not allow less


class CurrentNumbers(NamedTuple):
    """The values of IRUN and IHOLD, and what sets their full scale: `vsense` selects the smaller
    voltage range, `scaler` is the TMC5160's GLOBALSCALER in 256ths. `run_a` and `hold_a` are the
    resulting RMS currents in A."""

    irun: int
    ihold: int
    vsense: int
    scaler: int
    run_a: float
    hold_a: float


def current_numbers(
    chip: ChipName, resistor_ohm: float, run_a: float, hold_a: float
) -> CurrentNumbers:
    """The nearest values that the chip supports: I = (CS + 1) / 32 · full scale, with the smallest
    range that is large enough for both currents. The scaler of a TMC5160 is chosen so that the
    larger current uses the full scale."""
    ranges, most_a = CHIPS[chip].full_scale_v, max(run_a, hold_a)
    volts = next((v for v in ranges if full_scale_a(chip, resistor_ohm, v) >= most_a), max(ranges))
    full_a = full_scale_a(chip, resistor_ohm, volts)
    scaler = _SCALER_FULL
    if chip == "TMC5160":
        scaler = min(max(round(_SCALER_FULL * most_a / full_a), _SCALER_MIN), _SCALER_FULL)
        full_a *= scaler / _SCALER_FULL
    irun, ihold = _share(run_a, full_a), _share(hold_a, full_a)
    return CurrentNumbers(
        irun,
        ihold,
        int(len(ranges) > 1 and volts == min(ranges)),
        scaler,
        (irun + 1) / _STEPS * full_a,
        (ihold + 1) / _STEPS * full_a,
    )


def _share(ampere: float, full_a: float) -> int:
    return min(max(round(_STEPS * ampere / full_a) - 1, 0), _STEPS - 1)
