"""Power spectra of measured accelerations."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, log2

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_WINDOW_S = 0.5  # the windows are at least so long
_KAISER_BETA = 6.0
_DRIFT_HZ = 10.0  # below this the sweep dominates


class TooShortError(ValueError):
    """The measurement has fewer samples than one window."""


@dataclass(frozen=True, slots=True)
class Spectrum:
    """The power spectral density of an acceleration at each frequency `hz`: of X, Y, Z, in
    (mm/s²)²/Hz, or after `normalized` in (mm/s²)²/Hz²."""

    hz: Array
    x: Array
    y: Array
    z: Array

    @property
    def sum(self) -> Array:
        """The three axes together."""
        return self.x + self.y + self.z

    def up_to(self, hz: float) -> Spectrum:
        """The part up to this frequency."""
        kept = self.hz <= hz
        return Spectrum(self.hz[kept], self.x[kept], self.y[kept], self.z[kept])

    def normalized(self) -> Spectrum:
        """The spectrum divided by the frequency, because the acceleration of the excitation grows
        with the frequency; below 10 Hz it is reduced further."""
        shifted = self.hz + 0.1
        factor = 1 / shifted
        low = self.hz < _DRIFT_HZ
        factor[low] *= np.exp(1 - (_DRIFT_HZ / shifted[low]) ** 2)
        return Spectrum(self.hz, self.x * factor, self.y * factor, self.z * factor)

    @property
    def peak_hz(self) -> float:
        """The frequency of the highest bin."""
        return float(self.hz[int(np.argmax(self.sum))])


def window_samples(rate_hz: float) -> int:
    """The number of samples in a window: the smallest power of two that covers half a second."""
    return 1 << ceil(log2(max(_WINDOW_S * rate_hz, 2)))


def spectrum(samples: Array, rate_hz: float) -> Spectrum:
    """The spectrum of accelerations, mm/s², with a row (x, y, z) for each sample. It is the mean
    over windows that overlap by half (Welch, 1967). The mean of each window is subtracted, and a
    Kaiser window applied. Raises TooShortError."""
    size = window_samples(rate_hz)
    if len(samples) < size:
        raise TooShortError(f"{len(samples)} samples (minimum {size})")
    window = np.kaiser(size, _KAISER_BETA)
    found = [_density(samples[:, axis], window) / rate_hz for axis in range(3)]
    hz = np.arange(size // 2 + 1, dtype=np.float64) * (rate_hz / size)
    return Spectrum(hz, *found)


def _density(values: Array, window: Array) -> Array:
    size = len(window)
    rows = np.lib.stride_tricks.sliding_window_view(values, size)[:: size // 2]
    level = rows - rows.mean(axis=1, keepdims=True)
    power = np.abs(np.fft.rfft(level * window, axis=1)) ** 2
    density = power.mean(axis=0) / float(np.sum(window * window))
    density[1:-1] *= 2  # the negative frequencies
    return np.asarray(density, dtype=np.float64)
