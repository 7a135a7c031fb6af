"""Which input shaper fits a measured spectrum: the scores and the choice of Klipper's calibration,
so that both recommend the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np

from passo.config.shapers import DEFAULT_DAMPING, Impulses, ShaperType, impulses
from passo.resonance.fit import Fit
from passo.resonance.spectrum import Array, Spectrum

_MAX_HZ = 200.0  # bins above this do not count
_HIGHEST_HZ = 150.0  # of the candidates
_STEP_HZ = 0.2
_LOWEST_HZ: dict[ShaperType, float] = {
    "zv": 21.0,
    "mzv": 23.0,
    "zvd": 29.0,
    "ei": 29.0,
    "2hump_ei": 39.0,
    "3hump_ei": 48.0,
}
CANDIDATES: tuple[ShaperType, ...] = ("zv", "mzv", "ei", "2hump_ei", "3hump_ei")
_DAMPINGS = (0.075, 0.1, 0.15)  # of the real axis, which is not known
_QUIET = 20.0  # what is below 1/20 of the peak is not counted
_ACCEL_MM_S2, _CORNER_MM_S = 5000.0, 5.0  # at which smoothing is compared
_TARGET_MM = 0.12  # smoothing at the suggested acceleration


def smoothing_mm(found: Impulses, accel_mm_s2: float, corner_mm_s: float) -> float:
    """How far a shaper moves the path, mm: the larger distance of a reversal with this acceleration
    and a corner of 90° at this speed."""
    mean = sum(a * t for a, t in found)
    back = sum(a * 0.5 * accel_mm_s2 * (t - mean) ** 2 for a, t in found)
    corner = sqrt(2) * sum(
        a * (corner_mm_s + 0.5 * accel_mm_s2 * (t - mean)) * (t - mean)
        for a, t in found
        if t >= mean
    )
    return max(back, corner)


def max_accel(found: Impulses, corner_mm_s: float = _CORNER_MM_S) -> float:
    """The greatest acceleration, mm/s², with a smoothing of at most 0.12 mm; 0 if the corner
    exceeds this without acceleration. Reversal and corner are linear in the acceleration, so a
    closed form gives it."""
    mean = sum(a * t for a, t in found)
    back = sum(0.5 * a * (t - mean) ** 2 for a, t in found)
    later = [(a, t - mean) for a, t in found if t >= mean]
    fixed = sqrt(2) * corner_mm_s * sum(a * t for a, t in later)
    slope = sqrt(2) * sum(0.5 * a * t * t for a, t in later)
    return max(0.0, min(_TARGET_MM / back, (_TARGET_MM - fixed) / slope))


def residual(found: Impulses, hz: Array, damping: float) -> Array:
    """The vibration after a shaper at each frequency of an axis with this damping ratio, relative
    to that of one impulse (Singer and Seering, 1990)."""
    weights = np.array([a for a, _ in found])
    times = np.array([t for _, t in found])
    omega = 2 * np.pi * hz[:, None]
    sizes = weights * np.exp(-damping * omega * (times[-1] - times))
    angles = omega * sqrt(1 - damping * damping) * times
    return np.hypot((sizes * np.sin(angles)).sum(axis=1), (sizes * np.cos(angles)).sum(axis=1))


def fit(kind: ShaperType, measured: Spectrum, max_smoothing_mm: float | None = None) -> Fit:
    """The best frequency of one shaper for a normalized spectrum."""
    used = measured.up_to(_MAX_HZ)
    count = ceil((_HIGHEST_HZ - _LOWEST_HZ[kind]) / _STEP_HZ - 1e-9)
    results: list[Fit] = []
    for k in range(count - 1, -1, -1):
        hz = _LOWEST_HZ[kind] + k * _STEP_HZ
        found = impulses(kind, hz, DEFAULT_DAMPING)
        smooth = smoothing_mm(found, _ACCEL_MM_S2, _CORNER_MM_S)
        if max_smoothing_mm and results and smooth > max_smoothing_mm:
            break
        left = max(_remaining(found, used.hz, used.sum, damping) for damping in _DAMPINGS)
        score = smooth * (left**1.5 + 0.2 * left + 0.01)
        results.append(Fit(kind, hz, left, smooth, max_accel(found), score))
    best = min(results, key=lambda result: result.vibrations)
    near = [r for r in results if r.vibrations < best.vibrations * 1.1 + 0.0005]
    return min([best, *reversed(near)], key=lambda result: result.score)


def _remaining(found: Impulses, hz: Array, density: Array, damping: float) -> float:
    threshold = density.max() / _QUIET
    left = np.maximum(residual(found, hz, damping) * density - threshold, 0).sum()
    return float(left / np.maximum(density - threshold, 0).sum())


@dataclass(frozen=True, slots=True)
class Choice:
    """The fits of all shapers, the chosen one and the reason in words."""

    fits: tuple[Fit, ...]
    best: Fit
    reason: str


def choose(measured: Spectrum, max_smoothing_mm: float | None = None) -> Choice:
    """Fits each shaper, and takes a longer one only where it is clearly better."""
    fits = tuple(fit(kind, measured, max_smoothing_mm) for kind in CANDIDATES)
    best = fits[0]
    for new in fits[1:]:
        clearly = new.score * 1.2 < best.score
        shorter = new.score * 1.05 < best.score and new.smoothing_mm * 1.1 < best.smoothing_mm
        if clearly or shorter:
            best = new
    if best.kind == "zv":
        calmer = [f for f in fits if f.kind != "zv" and best.vibrations > f.vibrations * 1.1]
        best = calmer[0] if calmer else best
    return Choice(fits, best, _reason(fits, best))


def _reason(fits: Sequence[Fit], best: Fit) -> str:
    """Why this one: what the calmest and the shortest of the others would cost."""
    text = (
        f"{best.kind} at {best.frequency_hz:.1f} Hz leaves {best.vibrations:.1%} of the vibration"
        f" and cuts {best.smoothing_mm:.2f} mm off a corner at 5000 mm/s2."
    )
    shortest = min(fits, key=lambda f: f.smoothing_mm)
    calmest = min(fits, key=lambda f: f.vibrations)
    if shortest.kind != best.kind:
        text += f" {shortest.kind} cuts less ({shortest.smoothing_mm:.2f} mm)"
        text += f" but leaves {shortest.vibrations:.1%}."
    if calmest.kind != best.kind and calmest.vibrations < best.vibrations - 0.0005:
        text += f" {calmest.kind} leaves less ({calmest.vibrations:.1%})"
        text += f" but cuts {calmest.smoothing_mm:.2f} mm."
    return text
