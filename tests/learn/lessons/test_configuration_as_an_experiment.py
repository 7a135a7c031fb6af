"""Numbers by hand: 90° corners with 3000 mm/s² and 0.02 mm; sides of 40 mm at 100 mm/s."""

from math import sqrt

import pytest

from passo.learn.lessons.configuration_as_an_experiment import EXPERIMENT, LESSON

HALF = sqrt(0.5)  # sine of half of the angle
CORNER = sqrt(3000 * 0.02 * HALF / (1 - HALF))  # 12.04 mm/s


def test_corner_and_time_of_the_square():
    outcome = EXPERIMENT.run({"factor": 1})
    assert outcome["corner_mm_s"] == pytest.approx(CORNER, rel=1e-6)
    # two sides begin or end at rest: 160 mm at 100 mm/s, and what each ramp costs:
    # (v - u)² / (2·a·v), twice from rest and six times from the corner
    ramps = 2 * 100**2 + 6 * (100 - CORNER) ** 2
    assert outcome["before_s"] == pytest.approx(1.6 + ramps / (2 * 3000 * 100), rel=1e-4)
    assert outcome["change_percent"] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(
    ("key", "factor", "corner", "side_mm"),
    [
        ("deviation", 4, 2 * CORNER, 40),
        ("acceleration", 4, 2 * CORNER, 40),
        ("speed", 2, CORNER, 40),
        ("steps", 0.5, CORNER, 20),
    ],
)
def test_one_value_at_a_time(key, factor, corner, side_mm):
    outcome = EXPERIMENT.run({"key": key, "factor": factor})
    assert outcome["corner_mm_s"] == pytest.approx(corner, rel=1e-5)
    assert outcome["side_mm"] == side_mm


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(CORNER / 2, rel=1e-5)
    assert LESSON.asked(1).answer == pytest.approx(0, abs=1e-9)
    assert LESSON.asked(2).answer == 20
