"""Platinum resistors: the equation of Callendar and Van Dusen, from IEC 60751."""

from __future__ import annotations

from math import sqrt

A_PER_C = 3.9083e-3
B_PER_C2 = -5.775e-7
C_PER_C4 = -4.183e-12


def ohm(celsius: float, r0_ohm: float) -> float:
    """R = R0·(1 + A·t + B·t² + C·(t − 100)·t³), C only below 0 °C; from -200 to 850 °C."""
    t = celsius
    cold = C_PER_C4 * (t - 100) * t**3 if t < 0 else 0.0
    return r0_ohm * (1 + A_PER_C * t + B_PER_C2 * t * t + cold)


def celsius(ohm_: float, r0_ohm: float) -> float:
    """The temperature, °C, for a resistance: in closed form above 0 °C, by Newton's method
    below."""
    x = ohm_ / r0_ohm - 1
    t = (-A_PER_C + sqrt(A_PER_C * A_PER_C + 4 * B_PER_C2 * x)) / (2 * B_PER_C2)
    if t >= 0:
        return t
    for _ in range(50):
        wrong = ohm(t, 1.0) - 1 - x
        slope = A_PER_C + 2 * B_PER_C2 * t + C_PER_C4 * (4 * t - 300) * t * t
        t -= wrong / slope
        if abs(wrong) < 1e-15:
            break
    return t
