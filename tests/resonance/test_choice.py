"""The analysis against the golden run of Klipper's own, on an axis with a known resonance."""

from __future__ import annotations

import numpy as np
import pytest
from tests.resonance.axis import RATE_HZ, felt

from passo.config.shapers import ShaperType, impulses
from passo.resonance.choice import choose, max_accel, residual, smoothing_mm
from passo.resonance.excitation import Excitation
from passo.resonance.spectrum import TooShortError, spectrum

Row = tuple[ShaperType, float, float, float]


@pytest.mark.parametrize(
    ("hz", "damping", "peak", "rows", "best", "accel"),
    [
        (
            *(50.0, 0.08, 50.0),
            [
                ("zv", 50.0, 1.55, 0.0677),
                ("mzv", 51.0, 0.02, 0.0783),
                ("ei", 62.8, 0.04, 0.0835),
                ("2hump_ei", 80.6, 0.02, 0.0872),
                ("3hump_ei", 101.2, 0.02, 0.0883),
            ],
            *("mzv", 7662),
        ),
        (
            *(35.0, 0.1, 34.375),
            [
                ("zv", 35.2, 3.18, 0.1262),
                ("mzv", 34.8, 0.02, 0.1682),
                ("ei", 43.0, 0.04, 0.1782),
                ("2hump_ei", 55.2, 0.01, 0.1858),
                ("3hump_ei", 69.4, 0.01, 0.1877),
            ],
            *("mzv", 3568),
        ),
    ],
)
def test_one_resonance_is_found_as_by_klipper(
    hz: float, damping: float, peak: float, rows: list[Row], best: str, accel: int
) -> None:
    parts = [(part.seconds, part.accel_mm_s2) for part in Excitation().segments()]
    assert len(parts) == 36_615
    assert sum(seconds for seconds, _ in parts) == pytest.approx(130.002, abs=5e-4)
    noise = np.random.default_rng(1)
    x = felt(parts, hz, damping)
    x += noise.normal(0, 50, len(x))
    still = noise.normal(0, 50, (2, len(x)))
    samples = np.stack([x, *still], axis=1)
    found = spectrum(samples, RATE_HZ).normalized()
    assert found.peak_hz == peak
    choice = choose(found)
    for fit, (kind, expected_hz, percent, smooth) in zip(choice.fits, rows, strict=True):
        assert (fit.kind, round(fit.frequency_hz, 1)) == (kind, expected_hz)
        assert fit.vibrations * 100 == pytest.approx(percent, abs=0.0051)
        assert fit.smoothing_mm == pytest.approx(smooth, abs=5.1e-5)
    assert choice.best.kind == best
    assert choice.best.max_accel_mm_s2 == pytest.approx(accel, abs=0.6)
    assert f"{best} at {choice.best.frequency_hz:.1f} Hz leaves" in choice.reason
    assert "zv cuts less" in choice.reason


# type, residual in % at 40 and 60 Hz, smoothing, greatest acceleration; all at 50 Hz and 0.1
@pytest.mark.parametrize(
    ("kind", "at_40", "at_60", "smooth", "accel"),
    [
        ("zv", 27.040, 25.385, 0.067696, 9742.8),
        ("mzv", 19.087, 10.646, 0.081468, 7364.8),
        ("zvd", 7.311, 6.444, 0.123167, 4871.4),
        ("ei", 2.439, 2.145, 0.131798, 4552.4),
        ("2hump_ei", 5.019, 4.934, 0.226502, 2649.0),
        ("3hump_ei", 0.225, 0.731, 0.361658, 1533.2),
    ],
)
def test_single_shaper_is_evaluated(
    kind: ShaperType, at_40: float, at_60: float, smooth: float, accel: float
) -> None:
    found = impulses(kind, 50, 0.1)
    left = residual(found, np.array([40.0, 60.0]), 0.1) * 100
    assert left == pytest.approx([at_40, at_60], abs=6e-4)
    assert smoothing_mm(found, 5000, 5) == pytest.approx(smooth, abs=6e-7)
    assert max_accel(found) == pytest.approx(accel, abs=0.06)


def test_a_spectrum_keeps_the_power_of_a_tone() -> None:
    t = np.arange(6400) / RATE_HZ
    tone = 100 * np.sin(2 * np.pi * 75 * t)
    found = spectrum(np.stack([tone, 0 * t, 0 * t], axis=1), RATE_HZ)
    assert found.peak_hz == 75
    assert found.sum.sum() * found.hz[1] == pytest.approx(100**2 / 2, rel=1e-3)
    with pytest.raises(TooShortError):
        spectrum(np.zeros((2047, 3)), RATE_HZ)


def test_less_smoothing_on_request_takes_a_higher_frequency() -> None:
    parts = [(p.seconds, p.accel_mm_s2) for p in Excitation(20, 60, 2).segments()]
    x = felt(parts, 35, 0.1)
    found = spectrum(np.stack([x, 0 * x, 0 * x], axis=1), RATE_HZ).normalized()
    free, bounded = choose(found), choose(found, max_smoothing_mm=0.1)
    assert bounded.best.smoothing_mm <= 0.1 < free.best.smoothing_mm
    assert bounded.best.frequency_hz > free.best.frequency_hz
