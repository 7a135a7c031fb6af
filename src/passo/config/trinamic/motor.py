"""From the data sheet of a motor to the fields of its driver.

The formulas are those of klipper_tmc_autotune and of Trinamic's application notes: stealthChop
starts from the voltage that the motor needs, and the hysteresis of spreadCycle covers the ripple of
the current within one cycle of the chopper."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil, pi
from typing import Annotated

from pydantic import Field

from passo.config.trinamic.chips import Chip
from passo.config.types import Model, Positive

_BLANK_CLOCKS = (16, 24, 36, 54)  # by TBL
_PWM_CLOCKS = (1024, 683, 512, 410)  # by PWM_FREQ: two cycles of the clock are that many periods
_SMALL_HZ, _LARGE_HZ = 55_000, 20_000  # of the choppers of small and large drivers
_TOFF = (1, 15)
_SUPPLY_V = 24.0


class MotorConstants(Model):
    """The values in the data sheet of a motor. Passo computes `pwm_grad`, `pwm_ofs`, `pwm_freq`,
    `toff`, `hstrt` and `hend` of its driver from them."""

    resistance_ohm: Positive
    """The resistance of a coil."""
    inductance_mh: Positive
    """The inductance of a coil."""
    holding_torque_nm: Positive
    """The holding torque with `max_current_a` in both coils."""
    max_current_a: Positive
    """The rated current of a coil."""
    supply_v: Positive = _SUPPLY_V
    """The voltage of the driver's motor supply."""
    extra_hysteresis: Annotated[int, Field(ge=0, le=8)] = 0
    """Added to the computed hysteresis, against noise at low speed."""

    def silent_rev_s(self, fields: dict[str, int]) -> float:
        """The maximum speed, rev/s, at which stealthChop makes the full current."""
        return (255 - fields["pwm_ofs"]) / (pi * fields["pwm_grad"])

    def pwm(self, clock_hz: int, run_a: float, full_steps: int) -> dict[str, int]:
        """PWM_GRAD and PWM_OFS of stealthChop."""
        emf = self.holding_torque_nm / (2 * self.max_current_a)
        per_256 = self.supply_v * 256 * full_steps
        gradient = ceil(emf * 2 * pi * clock_hz * 1.46 / per_256)
        offset = ceil(374 * self.resistance_ohm * run_a / self.supply_v)
        return {"pwm_grad": min(gradient, 255), "pwm_ofs": min(offset, 254)}

    def hysteresis(self, clock_hz: int, run_a: float, toff: int, tbl: int) -> dict[str, int]:
        """HSTRT and HEND of spreadCycle. `toff` and `tbl` are values of these fields."""
        inductance_h = self.inductance_mh / 1000
        decay_s, blank_s = (24 + 32 * toff) / clock_hz, _BLANK_CLOCKS[tbl] / clock_hz
        ripple_a = self.supply_v * blank_s + 2 * self.resistance_ohm * run_a * decay_s
        wanted = ceil(max(0.5 + ripple_a / inductance_h * 2 * 248 / run_a - 8, -2))
        total = min(wanted + self.extra_hysteresis, 14)
        start = min(max(total, 1), 8)
        return {"hstrt": start - 1, "hend": min(total - start, 12) + 3}


def tuned_fields(
    chip: Chip,
    motor: MotorConstants,
    run_a: float,
    full_steps: int,
    given: Mapping[str, int],
) -> dict[str, int]:
    """The fields of a driver for a motor with this run current; `given` are fields that the machine
    file sets."""
    target = _LARGE_HZ if chip.currents.scaled or not chip.mode else _SMALL_HZ
    hz = chip.clock_hz
    toff = min(max(ceil((hz / (4 * target) - 24) / 32), _TOFF[0]), _TOFF[1])
    toff, tbl = given.get("toff", toff), given.get("tbl", chip.start["tbl"])
    fields = {"toff": toff} | motor.hysteresis(hz, run_a, toff, tbl)
    if chip.field("pwm_autograd"):
        fields |= motor.pwm(hz, run_a, full_steps)
    if chip.field("pwm_freq"):
        fits = [i for i, clocks in enumerate(_PWM_CLOCKS) if 2 * hz / clocks <= target]
        fields["pwm_freq"] = max(fits, default=0)
    return fields
