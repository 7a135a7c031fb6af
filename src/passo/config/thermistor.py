"""Thermistors: the equation of an NTC resistor, and its voltage divider."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log

ZERO_C = 273.15
_T25_K = 25 + ZERO_C
_STEP = 1024  # offsets of the ADC are in pairs of 1/1024 of full scale


@dataclass(frozen=True, slots=True)
class Ntc:
    """1/T = A + B·ln R + C·(ln R)³, T in kelvin (J. S. Steinhart, S. R. Hart, 1968), where B = 1/β
    and A follows from the resistance at 25 °C. C = 0 is the β equation."""

    r25_ohm: float
    beta_k: float
    c_per_k: float = 0.0

    @classmethod
    def through(
        cls, first: tuple[float, float], second: tuple[float, float], third: tuple[float, float]
    ) -> Ntc:
        """The equation through three points, °C and ohm, with x = ln R, by Newton's divided
        differences. Raises ZeroDivisionError for equal points."""
        (y1, x1), (y2, x2), (y3, x3) = (
            (1 / (celsius + ZERO_C), log(ohm)) for celsius, ohm in (first, second, third)
        )
        slope2, slope3 = (y2 - y1) / (x2 - x1), (y3 - y1) / (x3 - x1)
        c = (slope3 - slope2) / ((x3 - x2) * (x1 + x2 + x3))
        b = slope2 - c * (x1 * x1 + x1 * x2 + x2 * x2)
        a = y1 - b * x1 - c * x1**3
        x25 = x1
        for _ in range(20):
            x25 -= (a + b * x25 + c * x25**3 - 1 / _T25_K) / (b + 3 * c * x25 * x25)
        return cls(exp(x25), 1 / b, c)

    def celsius(self, ohm: float) -> float:
        """Temperature at a resistance above 0. Raises ValueError if the equation has no
        solution."""
        x, x25 = log(ohm), log(self.r25_ohm)
        inverse = 1 / _T25_K + (x - x25) / self.beta_k + self.c_per_k * (x**3 - x25**3)
        if inverse <= 0:
            raise ValueError(f"{ohm:g} ohm is beyond any temperature")
        return 1 / inverse - ZERO_C

    def ohm(self, celsius: float) -> float:
        """Resistance at a temperature, by Newton's method from the β equation."""
        x25 = log(self.r25_ohm)
        wanted = 1 / (celsius + ZERO_C) - 1 / _T25_K
        x = x25 + self.beta_k * wanted
        for _ in range(50):
            wrong = (x - x25) / self.beta_k + self.c_per_k * (x**3 - x25**3) - wanted
            step = wrong / (1 / self.beta_k + 3 * self.c_per_k * x * x)
            x -= step
            if abs(step) < 1e-12:
                break
        return exp(x)


@dataclass(frozen=True, slots=True)
class Divider:
    """A resistor to ground under a pull-up resistor to the ADC's full scale. The ADC reads
    2·`offset_low`/1024 for a true 0, and 1 + 2·`offset_high`/1024 for a true 1."""

    pullup_ohm: float
    offset_low: float = 0.0
    offset_high: float = 0.0

    def ohm(self, share: float) -> float:
        """Resistance at a fraction of full scale. Raises ValueError if it is open or shorted."""
        above = share - 2 * self.offset_low / _STEP
        below = 1 + 2 * self.offset_high / _STEP - share
        if above <= 0 or below <= 0:
            raise ValueError(f"a share of {share:g} means no resistance")
        return self.pullup_ohm * above / below

    def share(self, ohm: float) -> float:
        """Fraction of full scale at a resistance."""
        x = ohm / self.pullup_ohm
        return (x * (1 + 2 * self.offset_high / _STEP) + 2 * self.offset_low / _STEP) / (1 + x)
