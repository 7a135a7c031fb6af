"""The files of a measurement, in the form of Klipper's, so that its tools read them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from passo.config.shapers import DEFAULT_DAMPING, impulses
from passo.resonance.choice import Choice, residual
from passo.resonance.picture import Curve, picture
from passo.resonance.spectrum import Spectrum

_SHOWN_HZ = 200.0


def spectrum_csv(found: Spectrum, choice: Choice | None) -> str:
    """A row for each frequency: density of X, Y, Z and their sum; then what each shaper leaves."""
    shown = found.up_to(_SHOWN_HZ)
    head = ["freq", "psd_x", "psd_y", "psd_z", "psd_xyz"]
    columns = [shown.hz, shown.x, shown.y, shown.z, shown.sum]
    if choice is not None:
        head.append("shapers:")
        for fit in choice.fits:
            head.append(f"{fit.kind}({fit.frequency_hz:.1f})")
            shaper = impulses(fit.kind, fit.frequency_hz, DEFAULT_DAMPING)
            columns.append(residual(shaper, shown.hz, DEFAULT_DAMPING))
    lines = [",".join(head)]
    for row in zip(*(column.tolist() for column in columns), strict=True):
        texts = [f"{row[0]:.1f}", *(f"{value:.3e}" for value in row[1:5])]
        if choice is not None:
            texts += ["", *(f"{value:.3f}" for value in row[5:])]
        lines.append(",".join(texts))
    return "\n".join([*lines, ""])


def raw_csv(samples: Iterable[Sequence[float]], start_s: float, rate_hz: float) -> str:
    """A row for each sample: print time in s, and the acceleration along X, Y and Z in mm/s²."""
    lines = ["#time,accel_x,accel_y,accel_z"]
    for i, (x, y, z) in enumerate(samples):
        lines.append(f"{start_s + i / rate_hz:.6f},{x:.6f},{y:.6f},{z:.6f}")
    return "\n".join([*lines, ""])


def spectrum_svg(title: str, found: Spectrum, choice: Choice | None) -> str:
    """The picture of a normalized spectrum, with the shapers if a choice was made."""
    shown = found.up_to(_SHOWN_HZ)
    hz: list[float] = shown.hz.tolist()
    curves: list[Curve] = [("all axes", shown.sum.tolist(), False)]
    notes = [f"Peak at {shown.peak_hz:.1f} Hz"]
    if choice is None:
        for name, values in (("x", shown.x), ("y", shown.y), ("z", shown.z)):
            curves.append((name, values.tolist(), False))
        return picture(title, hz, curves, notes)
    best = impulses(choice.best.kind, choice.best.frequency_hz, DEFAULT_DAMPING)
    left = residual(best, shown.hz, DEFAULT_DAMPING)
    curves.append((f"with {choice.best.kind}", np.asarray(shown.sum * left).tolist(), False))
    for fit in choice.fits[:4]:
        shaper = impulses(fit.kind, fit.frequency_hz, DEFAULT_DAMPING)
        name = f"{fit.kind} {fit.frequency_hz:.1f} Hz"
        curves.append((name, residual(shaper, shown.hz, DEFAULT_DAMPING).tolist(), True))
    return picture(title, hz, curves, [*notes, *choice.reason.split("; ")])
