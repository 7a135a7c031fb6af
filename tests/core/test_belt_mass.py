"""A mass on a belt, and the pressure in a nozzle, as formulas: smooth motion in slices of 20 µs."""

from itertools import pairwise
from math import exp, inf, nan, pi, sqrt

import pytest

from passo import _core
from passo.config.shapers import SHAPER_TYPES, impulses

# A move of 20 mm at 100 mm/s and 3000 mm/s² with a shaper for 50 Hz and 0.1: the amplitude in µm
# at its end, if the real frequency is 50, 45 and 55 Hz.
_RINGING_UM = {
    None: (37.417, 52.224, 22.785),
    "zv": (0.0, 7.036, 2.974),
    "mzv": (0.0, 4.513, 1.480),
    "zvd": (0.0, 0.948, 0.388),
    "ei": (1.894, 1.712, 0.702),
    "2hump_ei": (0.019, 1.838, 0.766),
    "3hump_ei": (1.841, 1.928, 0.701),
}
_LONG_MM, _SPEED, _ACCEL, _DAMPING = 20.0, 100.0, 3000.0, 0.1
_RAMP_S = _SPEED / _ACCEL
_END_S = _LONG_MM / _SPEED + _RAMP_S


def trapezoid(t):
    """Position of the plain move at a time."""
    t = min(max(t, 0.0), _END_S)
    if t > _END_S - _RAMP_S:
        return _LONG_MM - _ACCEL * (_END_S - t) ** 2 / 2
    return _ACCEL * t * t / 2 if t < _RAMP_S else _SPEED * (t - _RAMP_S / 2)


@pytest.mark.parametrize("kind", [None, *SHAPER_TYPES])
def test_golden_ringing_of_smooth_motion(kind):
    shaper = impulses(kind, 50.0, _DAMPING) if kind else [(1.0, 0.0)]
    end, slice_s = _END_S + shaper[-1][1], 2e-5

    def shaped(t):
        return sum(a * trapezoid(t - at) for a, at in shaper)

    n = int(end / slice_s)
    jumps = [shaped((i + 0.5) * slice_s) for i in range(n)]
    found = []
    for frequency_hz in (50.0, 45.0, 55.0):
        mass = _core.BeltMass(frequency_hz, _DAMPING)
        for before, after in pairwise([0.0, *jumps]):
            mass.step(after - before)
            mass.run(slice_s)
        mass.step(_LONG_MM - jumps[-1])
        mass.run(end - n * slice_s)
        found.append(mass.ringing * 1000)
    assert found == pytest.approx(_RINGING_UM[kind], abs=0.003)


def test_mass_vibrates_freely_by_its_formula():
    mass = _core.BeltMass(40.0, 0.05)
    mass.step(0.1)
    rate = 0.05 * 2 * pi * 40
    for _ in range(7):
        mass.run(1 / (40 * sqrt(1 - 0.05**2)))  # one cycle
    assert mass.deviation == pytest.approx(-0.1 * exp(-rate * 7 / (40 * sqrt(1 - 0.05**2))))
    # Velocity and acceleration are the derivatives of the deviation.
    before, h = (mass.deviation, mass.velocity, mass.acceleration), 1e-6
    mass.run(h)
    assert mass.deviation - before[0] == pytest.approx(h * before[1], abs=1e-8)
    assert mass.velocity - before[1] == pytest.approx(h * before[2], rel=1e-2)


@pytest.mark.parametrize("bad", [0.0, inf, nan])
def test_impossible_mass_and_nozzle_are_refused(bad):
    with pytest.raises(ValueError, match="damping ratio above 0"):
        _core.BeltMass(50.0, bad)
    with pytest.raises(ValueError, match="the frequency of a mass must be"):
        _core.BeltMass(bad, 0.1)
    with pytest.raises(ValueError, match="the time constant of a nozzle must be"):
        _core.NozzlePressure(bad)


@pytest.mark.parametrize("bad", [inf, nan])
def test_mass_and_nozzle_refuse_what_is_not_finite(bad):
    for each in (_core.BeltMass(50.0, 0.1), _core.NozzlePressure(0.05)):
        with pytest.raises(ValueError, match="seconds must be a finite number"):
            each.run(bad)
        with pytest.raises(ValueError, match="mm must be a finite number"):
            each.step(bad)


# 100, 5 and 100 mm/s of line at 3000 mm/s² through a nozzle with 0.05 s: the widest and narrowest
# line as a multiple, and the integral of its error over 0.3 s before and after the turn, in mm.
_NOZZLE_S, _DIP_S = 0.05, 95 / 3000


def speed(t):
    return 5.0 + min(3000.0 * abs(t), 95.0)


def advanced(t, advance_s, half_s):
    """Speed of the extruder: the advance is smoothed by a triangle of this half width."""
    if advance_s == 0:
        return speed(t)
    if half_s == 0:
        slope = 0.0 if abs(t) > _DIP_S else 3000.0 if t > 0 else -3000.0
        return speed(t) + advance_s * slope

    def mean(low, high):  # of the speed, by its integral
        def integral(x):
            inner = min(abs(x), _DIP_S)
            whole = 5.0 * inner + 1500.0 * inner**2 + 100.0 * max(abs(x) - _DIP_S, 0.0)
            return whole if x > 0 else -whole

        return (integral(high) - integral(low)) / (high - low)

    return speed(t) + advance_s * (mean(t, t + half_s) - mean(t - half_s, t)) / half_s


@pytest.mark.parametrize(
    ("advance_s", "half_s", "widest", "narrowest", "error_mm"),
    [
        (0.0, 0.0, 15.07, 0.670, 3.72),
        (0.05, 0.02, 4.84, 0.894, 0.420),
        (0.05, 0.01, 2.96, 0.949, 0.117),
        (0.04, 0.02, 6.89, 0.849, 1.01),
        (0.06, 0.02, 2.80, 0.824, 0.667),
    ],
)
def test_golden_width_of_a_line(advance_s, half_s, widest, narrowest, error_mm):
    nozzle, slice_s = _core.NozzlePressure(_NOZZLE_S), 1e-4
    error, widths = 0.0, [1.0]
    for i in range(-7000, 3000):
        nozzle.run(slice_s / 2)
        nozzle.step(slice_s * advanced((i + 0.5) * slice_s, advance_s, half_s))
        nozzle.run(slice_s / 2)
        at = speed((i + 1) * slice_s)
        if i >= -3000:
            error += slice_s * abs(nozzle.flow - at)
            widths.append(nozzle.flow / at)
    assert max(widths) == pytest.approx(widest, rel=0.01)
    assert min(widths) == pytest.approx(narrowest, abs=0.002)
    assert error == pytest.approx(error_mm, abs=0.01)
