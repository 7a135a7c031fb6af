"""The core's trigonometry against series in 60 decimal digits."""

from __future__ import annotations

import random
from decimal import Decimal, getcontext
from math import inf, nextafter, ulp
from math import pi as math_pi

import pytest

from passo._core import atan2, sincos

getcontext().prec = 60
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")


def exact_sine(x):
    """Series after reduction by the nearest multiple of 2π."""
    x -= 2 * PI * (x / (2 * PI)).to_integral_value()
    term = total = x
    n = 1
    while abs(term) > Decimal("1e-50"):
        term *= -x * x / ((n + 1) * (n + 2))
        total += term
        n += 2
    return total


def exact_arctangent(t):
    """Argument halved until the series runs fast: atan t = 2 atan(t / (1 + √(1 + t²)))."""
    halvings = 0
    while abs(t) > Decimal("0.05"):
        t /= 1 + (1 + t * t).sqrt()
        halvings += 1
    power = total = t
    n = 1
    while abs(power) > Decimal("1e-50"):
        power *= -t * t
        n += 2
        total += power / n
    return total * 2**halvings


def exact_atan2(y, x):
    y, x = Decimal(y), Decimal(x)
    if x == 0:
        return PI / 2 * (1 if y > 0 else -1)
    angle = exact_arctangent(y / x)
    return angle if x > 0 else angle + PI * (1 if y >= 0 else -1)


def error_ulp(value, exact):
    return abs(Decimal(value) - exact) / Decimal(ulp(float(exact)))


def angles():
    rng = random.Random(1)
    yield from (k * math_pi / 4 for k in range(-40, 41))
    yield from (nextafter(k * math_pi / 4, inf) for k in range(-40, 41))
    for scale in (1e-9, 1e-3, 1.0, 10.0, 1e3, 1e6):
        yield from (rng.uniform(-scale, scale) for _ in range(300))


def points():
    rng = random.Random(2)
    for scale in (1e-6, 1e-3, 0.4, 0.7, 1.2, 2.5, 1e3, 1e6):
        for _ in range(300):
            x = rng.uniform(-200, 200)
            yield x * scale * rng.uniform(-1, 1), x
    for tangent in (0.4375, 0.6875, 1.1875, 2.4375):  # between the pieces
        yield from ((nextafter(tangent, to), 1.0) for to in (-inf, inf))


def test_sine_and_cosine_are_within_one_ulp():
    worst = max(
        max(error_ulp(s, exact_sine(Decimal(x))), error_ulp(c, exact_sine(Decimal(x) + PI / 2)))
        for x in angles()
        for s, c in [sincos(x)]
    )
    assert worst <= 1


def test_arctangent_is_within_one_ulp():
    worst = max(error_ulp(atan2(y, x), exact_atan2(y, x)) for y, x in points())
    assert worst <= 1


@pytest.mark.parametrize(
    ("y", "x", "angle"),
    [
        (0.0, 0.0, 0.0),
        (0.0, 1.0, 0.0),
        (0.0, -1.0, math_pi),
        (1.0, 0.0, math_pi / 2),
        (-1.0, 0.0, -math_pi / 2),
        (1.0, 1.0, math_pi / 4),
        (-1.0, -1.0, -3 * math_pi / 4),
    ],
)
def test_arctangent_of_the_axes_and_diagonals(y, x, angle):
    assert atan2(y, x) == angle


def test_sine_of_zero_keeps_the_sign():
    assert sincos(0.0) == (0.0, 1.0)
    for x in (0.1, 1.0, 2.0, 4.0, 6.0):
        s, c = sincos(x)
        assert sincos(-x) == (-s, c)
