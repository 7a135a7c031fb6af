"""From amperes to the numbers in a driver's registers, and back."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor, sqrt
from typing import NamedTuple

_STEPS = 32  # values of IRUN and IHOLD: 0 is 1/32 of full scale
_SCALER_FULL = 256
_SCALER_MIN = 32  # the data sheets do not allow less


class CurrentRange(NamedTuple):
    """A range of a chip: the value of the field that selects it, and its full scale: the voltage
    over the sense resistor, or A·Ω of a TMC2240 and its reference resistor."""

    value: int
    volts: float


class CurrentNumbers(NamedTuple):
    """The values of the fields that set the current, and the resulting RMS currents in A."""

    fields: dict[str, int]
    run_a: float
    hold_a: float


@dataclass(frozen=True, slots=True)
class CurrentLaw:
    """How a chip sets its current: I = (CS + 1) / 32 · V / (R + R inside) / √2, RMS. `ranges` rise;
    `select` is the field that selects one, if there are several. With `scaled`, GLOBALSCALER
    multiplies the full scale by 32/256 to 256/256. `hold` is empty if the chip has one current."""

    ranges: tuple[CurrentRange, ...]
    resistor_ohm: float
    """The usual resistor of modules."""
    select: str = ""
    inner_ohm: float = 0.0
    scaled: bool = False
    run: str = "irun"
    hold: str = "ihold"

    @property
    def fields(self) -> set[str]:
        """The fields that the currents set."""
        scaler = "globalscaler" if self.scaled else ""
        return {self.select, self.run, self.hold, scaler} - {""}

    def _full_scale_a(self, resistor_ohm: float, volts: float) -> float:
        return volts / (resistor_ohm + self.inner_ohm) / sqrt(2)

    def largest_ma(self, resistor_ohm: float) -> int:
        """The maximum RMS current, mA, rounded down."""
        return floor(1000 * self._full_scale_a(resistor_ohm, self.ranges[-1].volts))

    def least_ma(self, resistor_ohm: float) -> int:
        """The minimum RMS current, mA, rounded up."""
        least = 1 / _STEPS * (_SCALER_MIN / _SCALER_FULL if self.scaled else 1)
        return ceil(1000 * least * self._full_scale_a(resistor_ohm, self.ranges[0].volts))

    def numbers(self, resistor_ohm: float, run_a: float, hold_a: float) -> CurrentNumbers:
        """The nearest values that the chip supports, in the smallest range that is large enough for
        both currents. The scaler is chosen so that the larger current uses the full scale."""
        most_a = max(run_a, hold_a) if self.hold else run_a
        full = {found: self._full_scale_a(resistor_ohm, found.volts) for found in self.ranges}
        chosen = next((found for found in self.ranges if full[found] >= most_a), self.ranges[-1])
        full_a, fields = full[chosen], {self.select: chosen.value} if self.select else {}
        if self.scaled:
            scaler = round(_SCALER_FULL * most_a / full_a)
            scaler = min(max(scaler, _SCALER_MIN), _SCALER_FULL)
            full_a *= scaler / _SCALER_FULL
            fields["globalscaler"] = scaler % _SCALER_FULL  # 0 is 256
        fields[self.run] = run = _share(run_a, full_a)
        made_a = (run + 1) / _STEPS * full_a
        if not self.hold:
            return CurrentNumbers(fields, made_a, made_a)
        fields[self.hold] = hold = _share(hold_a, full_a)
        return CurrentNumbers(fields, made_a, (hold + 1) / _STEPS * full_a)


def _share(ampere: float, full_a: float) -> int:
    return min(max(round(_STEPS * ampere / full_a) - 1, 0), _STEPS - 1)
