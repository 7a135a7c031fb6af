"""Tuning rules: PID gains from an oscillation."""

from __future__ import annotations

from dataclasses import dataclass

FULL_POWER = 255.0  # in the unit of gains, as in Klipper and Marlin


@dataclass(frozen=True, slots=True)
class Gains:
    """PID gains in 1/255 of full power per °C, per °C·s and per °C/s."""

    kp: float
    ki: float
    kd: float

    def __str__(self) -> str:
        """The gains as Marlin's M303 shows them."""
        return f"Kp:{self.kp:.2f} Ki:{self.ki:.2f} Kd:{self.kd:.2f}"


@dataclass(frozen=True, slots=True)
class Rule:
    """Kp = `p`·Ku, Ki = `i`·Ku/Tu, Kd = `d`·Ku·Tu, with the ultimate gain Ku and its period Tu."""

    name: str
    p: float
    i: float
    d: float

    def gains(self, ku: float, tu_s: float) -> Gains:
        """The gains, in the unit of `ku`."""
        return Gains(self.p * ku, self.i * ku / tu_s, self.d * ku * tu_s)


# In the order of R of M303: J. G. Ziegler and N. B. Nichols (1942) and softer forms of it, the
# Pessen integral rule (1953), B. D. Tyreus and W. L. Luyben (1992).
RULES = (
    Rule("Classic PID", 0.6, 1.2, 0.075),
    Rule("Some Overshoot PID", 0.33, 0.66, 0.11),
    Rule("No Overshoot PID", 0.2, 0.4, 0.2 / 3),
    Rule("Pessen Integral Rule PID", 0.7, 1.75, 0.105),
    Rule("Tyreus-Lyben PID", 0.4545, 0.4545 / 2.2, 0.4545 / 6.3),
)
