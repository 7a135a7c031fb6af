"""The settings of a driver, and the registers that hold them."""

from __future__ import annotations

from dataclasses import dataclass

from passo.board.trinamic import registers as r
from passo.board.trinamic.current import CurrentNumbers, current_numbers
from passo.config.trinamic import ChipName

# Chopper: slow decay of 3, hysteresis 4 and 1, blanking 2, the start values of the data sheets.
_CHOPPER = {"toff": 3, "hstrt": 4, "hend": 1, "tbl": 2}
_SEND_DELAY = 2  # 24 bit times before an answer: the minimum with several drivers on one UART
_STANDSTILL = 20  # · 2¹⁸ clocks from the last step until the current decreases: 0.44 s
_HOLD_DELAY = 8  # · 2¹⁸ clocks for each step of the current
_ALL_FLAGS = 7  # of GSTAT; writing a 1 clears a flag


@dataclass(frozen=True, slots=True)
class DriverSettings:
    """A driver's settings. Currents are RMS values in A. `threshold` is TPWMTHRS, in clocks of the
    chip per 1/256 of a full step: the driver uses stealthChop while a step takes longer, and
    spreadCycle while it takes less. None: always spreadCycle."""

    chip: ChipName
    run_a: float
    hold_a: float
    resistor_ohm: float
    microsteps: int = 16
    interpolate: bool = True
    threshold: int | None = None

    @property
    def currents(self) -> CurrentNumbers:
        """The currents as numbers for the registers, which round them."""
        return current_numbers(self.chip, self.resistor_ohm, self.run_a, self.hold_a)

    def writes(self) -> list[tuple[int, int]]:
        """Registers and their values, in the order of writing."""
        chip, currents = r.CHIPS[self.chip], self.currents
        stealth = self.threshold is not None
        general: dict[int, int] = {}
        if self.chip in ("TMC2208", "TMC2209"):
            general[r.GCONF] = chip.pack(
                r.GCONF,
                en_spreadcycle=int(not stealth),
                pdn_disable=1,
                mstep_reg_select=1,
                multistep_filt=1,
            )
            general[r.SLAVECONF] = chip.pack(r.SLAVECONF, senddelay=_SEND_DELAY)
            pwm = chip.pack(
                r.PWMCONF, pwm_ofs=36, pwm_freq=1, pwm_autoscale=1, pwm_autograd=1, pwm_reg=1,
                pwm_lim=12,
            )  # fmt: skip
        elif self.chip == "TMC2130":
            general[r.GCONF] = chip.pack(r.GCONF, en_pwm_mode=int(stealth))
            pwm = chip.pack(r.PWMCONF, pwm_ampl=200, pwm_grad=1, pwm_autoscale=1)
        else:
            general[r.GCONF] = chip.pack(r.GCONF, en_pwm_mode=int(stealth), multistep_filt=1)
            general[r.GLOBALSCALER] = currents.scaler & 0xFF  # 0 is 256
            pwm = chip.pack(
                r.PWMCONF, pwm_ofs=30, pwm_autoscale=1, pwm_autograd=1, pwm_reg=4, pwm_lim=12
            )
        chopper = _CHOPPER | {
            "mres": 8 - (self.microsteps.bit_length() - 1),
            "intpol": int(self.interpolate),
        }
        if "vsense" in chip.fields[r.CHOPCONF]:
            chopper["vsense"] = currents.vsense
        current = chip.pack(
            r.IHOLD_IRUN, ihold=currents.ihold, irun=currents.irun, iholddelay=_HOLD_DELAY
        )
        # Write the chopper after the currents, because the chopper lets current flow.
        return [
            *general.items(),
            (r.IHOLD_IRUN, current),
            (r.TPOWERDOWN, _STANDSTILL),
            (r.TPWMTHRS, self.threshold or 0),
            (r.PWMCONF, pwm),
            (r.CHOPCONF, chip.pack(r.CHOPCONF, **chopper)),
            (r.GSTAT, _ALL_FLAGS),
        ]


def threshold_of(microsteps_s: float, microsteps: int) -> int:
    """TPWMTHRS for a speed in microsteps per second; `microsteps` is the number of microsteps in a
    full step. TSTEP counts clocks per 1/256 of a full step."""
    if microsteps_s <= 0:
        return r.THRESHOLD_MAX
    return min(round(r.CLOCK_HZ * microsteps / (256 * microsteps_s)), r.THRESHOLD_MAX)
