"""Several Z motors, bed screws and skew: what to change, from what was measured."""

from __future__ import annotations

from math import cos, radians, sin, sqrt

import pytest

from passo._core import Geometry
from passo.errors import CommandError
from passo.levelling.screws import adjustments
from passo.levelling.skew import skew_degrees, skew_factor
from passo.levelling.z_motors import (
    check_progress,
    gantry_adjustments,
    lifts,
    tilt_adjustments,
)


def test_golden_adjustments_of_three_motors():
    pivots = [(-50, 18), (125, 298), (300, 18)]
    points = [(30, 20, 0.300), (125, 220, -0.120), (220, 20, 0.075)]
    found = tilt_adjustments(pivots, points)
    assert found == pytest.approx([0.397812, -0.239925, -0.016662], abs=1e-6)
    # Each motor goes up: the front of the bed is high, so the gantry must be lifted there.
    up = lifts(dict(zip(("z", "z1", "z2"), found, strict=True)), 2)
    assert up == pytest.approx({"z": 0.637737, "z1": 0, "z2": 0.223263}, abs=2e-6)


@pytest.mark.parametrize("y", [0, 130])
def test_golden_adjustments_of_two_motors_at_any_y(y):
    points = [(15, y, 0.21), (220, y, -0.10)]
    found = tilt_adjustments([(-56, 20), (294, -20)], points)
    assert found == pytest.approx([0.317366, -0.211902], abs=1e-6)


def test_one_point_gives_no_tilt():
    with pytest.raises(
        CommandError, match="1 points are too few for the tilt correction: at least 2"
    ):
        tilt_adjustments([(0, 0)], [(0, 0, 1)])
    with pytest.raises(CommandError, match=r"0\.000 mm apart"):
        tilt_adjustments([(0, 0)], [(5, 5, 1), (5, 5, 2)])


def test_golden_adjustments_of_a_gantry():
    bed = [2.80, 2.65, 2.62, 2.55]
    places = [(50, 25), (50, 225), (250, 225), (250, 25)]
    points = [(x, y, 10 - b) for (x, y), b in zip(places, bed, strict=True)]
    found = gantry_adjustments(points, ((-60, -10), (360, 370)))
    assert found == pytest.approx([0.340925, -0.173975, 0.097975, -0.264925], abs=1e-6)


def test_a_motor_that_would_go_too_far_is_refused():
    """Also if only the lowest one is far from the others."""
    assert lifts({"z": 0.5, "z1": -1.4}, 2) == pytest.approx({"z": 1.9, "z1": 0})
    with pytest.raises(CommandError, match=r"motor z1 .* 2\.100 mm .* at most 2 mm"):
        lifts({"z": -1.6, "z1": 0.5}, 2)


def test_motors_in_a_wrong_order_are_found_at_the_first_rise():
    check_progress([0.4], ["z", "z1"])
    check_progress([0.4, 0.1, 0.1], ["z", "z1"])
    with pytest.raises(CommandError, match=r"0\.700 mm, before it by 0\.400 mm.*z, z1"):
        check_progress([0.4, 0.7], ["z", "z1"])


@pytest.mark.parametrize(
    ("z", "m3"), [(2.36, "CW 00:15"), (2.715, "CCW 00:27"), (2.4725, "CW 00:02"), (1.7, "CW 01:34")]
)
def test_golden_turns_of_screws(z, m3):
    base, screw = adjustments([("front left", 2.4875), ("back", z)], "M3 cw")
    assert base.adjust == "CW 00:00"
    assert screw.adjust == m3
    (_, other) = adjustments([("front left", 2.4875), ("back", z)], "M3 ccw")
    assert other.adjust[-5:] == m3[-5:]
    assert other.clockwise != screw.clockwise


def test_almost_a_whole_turn_of_a_screw_is_one():
    _, screw = adjustments([("a", 0.999), ("b", 0)], "M6 cw")
    assert screw.adjust == "CW 01:00"


def test_a_screw_that_is_off_by_less_than_a_micrometre_stays():
    _, screw = adjustments([("a", 0), ("b", 0.0009)], "M3 cw")
    assert screw.adjust == "CW 00:00"


def test_golden_skew():
    factor = skew_factor(140.4, 142.8, 99.8)
    assert factor == pytest.approx(-0.016951, abs=1e-6)
    assert skew_degrees(factor) == pytest.approx(-0.9712, abs=1e-4)


def test_skew_undoes_what_the_axes_do():
    """A Y axis that leans by 2 degrees to +X: the nozzle is where the program says."""
    lean, side = radians(2), 100.0
    a, b = (0.0, 0.0), (side * sin(lean), side * cos(lean))
    c, d = (b[0] + side, b[1]), (side, 0.0)
    ac = sqrt((c[0] - a[0]) ** 2 + (c[1] - a[1]) ** 2)
    bd = sqrt((d[0] - b[0]) ** 2 + (d[1] - b[1]) ** 2)
    kernel = Geometry({"kind": "cartesian", "skew": [skew_factor(ac, bd, side), 0.0, 0.0]})
    x, y, z = (kernel.inverse(i, (30, 50, 5)) for i in range(3))
    # The machine's Y moves the nozzle along the leaning axis; its length is that of the axis.
    assert (x + y * (b[0] / b[1]), y, z) == pytest.approx((30, 50, 5))


def test_lengths_of_no_parallelogram_are_refused():
    with pytest.raises(CommandError, match="no parallelogram has the lengths 10, 10, 100 mm"):
        skew_factor(10, 10, 100)
