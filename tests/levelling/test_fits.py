"""Planes and quadrics through probed heights (facts: A1 and A2 are exact rational solutions)."""

from __future__ import annotations

from fractions import Fraction
from math import cos, pi, sin, sqrt
from random import Random

import pytest

from passo.errors import CommandError
from passo.levelling.fits import Fit, check_points, fit

A1 = [
    (-80.0, -60.0, 0.1296),
    (80.0, -60.0, 0.5264),
    (0.0, 90.0, 0.1065),
    (0.0, 0.0, 0.12),
    (-70.0, 40.0, 0.0154),
    (60.0, 50.0, 0.2145),
]
A2 = [
    (float(x), float(y), z)
    for (x, y), z in zip(
        [(x, y) for y in (20, 100, 180) for x in (20, 100, 180)],
        [0.112, 0.047, 0.096, 0.083, -0.031, 0.069, 0.155, 0.058, 0.141],
        strict=True,
    )
]


def normal_equations(points, unknowns):
    """The same by another way: AᵀA x = Aᵀb in rational numbers, by elimination."""
    rows = []
    for x, y, _ in points:
        x, y = Fraction(x), Fraction(y)
        rows.append([Fraction(1), x, y, x * x, x * y, y * y][:unknowns])
    values = [Fraction(z) for *_, z in points]
    n = unknowns
    m = [[sum(r[i] * r[j] for r in rows) for j in range(n)] for i in range(n)]
    for i in range(n):
        m[i].append(sum(r[i] * v for r, v in zip(rows, values, strict=True)))
    for i in range(n):
        pivot = next(k for k in range(i, n) if m[k][i] != 0)
        m[i], m[pivot] = m[pivot], m[i]
        m[i] = [a / m[i][i] for a in m[i]]
        for k in range(n):
            if k != i:
                m[k] = [a - m[k][i] * b for a, b in zip(m[k], m[i], strict=True)]
    return [float(row[n]) for row in m]


GOLDEN = [
    (A1, "quadratic", (0.12, 0.002, -0.0015, 1e-5, -8e-6, 1.5e-5), 0.0),
    (A1, "linear", (0.205058439643, 0.002155300931, -0.001606627143, 0, 0, 0), 0.048863799953),
    (
        A2,
        "quadratic",
        (
            0.2010763888889,
            -0.0027453125,
            -0.00171302083333,
            1.322916666667e-5,
            7.8125e-8,
            9.557291666667e-6,
        ),
        0.009787242894,
    ),
    (A2, "linear", (0.06965277777778, -9.166666667e-5, 2.0625e-4, 0, 0, 0), 0.050202614163),
]


@pytest.mark.parametrize(("points", "method", "coefficients", "rms"), GOLDEN)
def test_golden_fits(points, method, coefficients, rms):
    found = fit(points, method)
    assert found.coefficients == pytest.approx(coefficients, rel=1e-9, abs=1e-12)
    assert found.residual_rms == pytest.approx(rms, abs=1e-11)


def test_height_of_a_fit():
    assert fit(A2, "quadratic").height(60, 150) == pytest.approx(0.042771701389, abs=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_fits_are_those_of_the_normal_equations(seed):
    random = Random(seed)
    points = [
        (random.uniform(150, 350), random.uniform(-100, 50), random.gauss(0, 0.2))
        for _ in range(random.randint(8, 30))
    ]
    for method, unknowns in (("linear", 3), ("quadratic", 6)):
        expected = normal_equations(points, unknowns)
        found = fit(points, method)
        assert found.coefficients[:unknowns] == pytest.approx(expected, rel=1e-8)
        square = sum((Fit(*expected).height(x, y) - z) ** 2 for x, y, z in points)
        assert found.residual_rms == pytest.approx(sqrt(square / len(points)), rel=1e-9)


def test_fits_add_up():
    """What a second run measures above a corrected bed is added, as APrinter does."""
    first = fit(A1, "linear")
    left = [(x, y, z - first.height(x, y)) for x, y, z in A1]
    both = first + fit(left, "quadratic")
    assert both.coefficients == pytest.approx(fit(A1, "quadratic").coefficients, abs=1e-12)
    assert both.residual_rms == pytest.approx(0, abs=1e-12)


HEXAGON = [(100 + 80 * cos(k * pi / 3), 50 + 80 * sin(k * pi / 3)) for k in range(6)]
REFUSED = {
    "two": ([(0, 0), (100, 0)], "linear", "2 points are too few .* linear .* at least 3"),
    "five": (HEXAGON[:5], "quadratic", "5 points are too few .* quadratic .* at least 6"),
    "a line": (
        [(0, 0), (50, 50.5), (100, 100)],
        "linear",
        r"the 3 points are too close to one line: they deviate from it by 0\.236 mm, and at least"
        r" 1 mm",
    ),
    "close": (
        [(0, 0), (100, 0), (0, 100), (100.3, 0.4)],
        "linear",
        r"points 2 and 4 are 0\.500 mm apart and count as one: at least 1 mm",
    ),
    "a hexagon": (HEXAGON, "quadratic", "the 6 points are on one conic .* 5 of 6"),
    "two rows": (
        [(x, y) for y in (0, 80) for x in (0, 50, 100)],
        "quadratic",
        "the 6 points are on one conic .* 5 of 6",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_points_that_do_not_determine_a_fit_are_refused(name):
    places, method, words = REFUSED[name]
    with pytest.raises(CommandError, match=words):
        check_points(places, method)
    with pytest.raises(CommandError, match=words):
        fit([(x, y, 0.1) for x, y in places], method)


def test_a_hexagon_with_its_middle_is_enough():
    found = fit([(x, y, x * y * 1e-5) for x, y in [*HEXAGON, (100, 50)]], "quadratic")
    assert found.coefficients == pytest.approx((0, 0, 0, 0, 1e-5, 0), abs=1e-12)


def test_a_height_that_is_not_a_number_is_refused():
    with pytest.raises(CommandError, match="the height at point 2 is nan"):
        fit([(0, 0, 0), (100, 0, float("nan")), (0, 100, 0)], "linear")


@pytest.mark.parametrize(
    ("method", "factor", "limit"), [("linear", 0.54, 1.9), ("quadratic", 0.77, 1.7)]
)
def test_noise_of_the_probe_becomes_noise_of_the_fit(method, factor, limit):
    sigma, random, errors = 0.005, Random(1), []
    for _ in range(40):
        points = [
            (x, y, random.gauss(0, sigma))
            for y in (20.0, 100.0, 180.0)
            for x in (20.0, 100.0, 180.0)
        ]
        found = fit(points, method)
        squares = [found.height(x, y) ** 2 for x in range(0, 201, 20) for y in range(0, 201, 20)]
        errors.append(sqrt(sum(squares) / len(squares)))
    mean = sum(errors) / len(errors)
    assert mean == pytest.approx(factor * sigma, rel=0.2)
    assert max(errors) < 1.2 * limit * factor * sigma
