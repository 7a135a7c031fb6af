"""A mass on a belt, exact between the changes of acceleration: the oracle of the measurement."""

from __future__ import annotations

from cmath import exp
from collections.abc import Iterable
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

RATE_HZ = 3200.0


def felt(
    segments: Iterable[tuple[float, float]], hz: float, damping: float, rate_hz: float = RATE_HZ
) -> NDArray[np.float64]:
    """The acceleration of the mass, mm/s2, at even times, for (seconds, acceleration of the motor).

    z is the distance from the motor: z'' + 2*damping*w*z' + w^2*z = -u''. With the complex state
    q = z' - conj(r)*z, r the root -damping*w + i*w_d, q' = r*q - u'' is solved exactly.
    """
    w = 2 * pi * hz
    root = complex(-damping * w, w * sqrt(1 - damping * damping))
    times, states, accels = [0.0], [0j], []
    for seconds, accel in segments:
        steady = accel / root
        states.append((states[-1] - steady) * exp(root * seconds) + steady)
        times.append(times[-1] + seconds)
        accels.append(accel)
    at = np.arange(int(times[-1] * rate_hz)) / rate_hz
    index = np.searchsorted(times, at, side="right") - 1
    steady = np.array(accels)[index] / root
    q = (np.array(states)[index] - steady) * np.exp(root * (at - np.array(times)[index])) + steady
    z = q.imag / root.imag
    slope = q.real + root.real * z
    return -2 * damping * w * slope - w * w * z
