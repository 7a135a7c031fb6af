"""Numbers by hand: v² = 2·a·s, t = v / a."""

import pytest

from passo.learn.lessons.trapezoid_and_triangle import EXPERIMENT, LESSON


def test_trapezoid():
    outcome = EXPERIMENT.run({"length_mm": 60, "speed_mm_s": 100, "acceleration_mm_s2": 1000})
    found = {number.name: number.value for number in outcome.numbers}
    assert found == pytest.approx(
        {
            "shape": 1,
            "top_mm_s": 100,
            "ramp_mm": 5,  # 100² / 2000
            "ramp_s": 0.1,
            "cruise_mm": 50,
            "total_s": 0.7,  # 0.1 + 50/100 + 0.1
        },
        rel=1e-6,
    )


def test_triangle():
    outcome = EXPERIMENT.run({"length_mm": 4, "speed_mm_s": 100, "acceleration_mm_s2": 1000})
    assert outcome["shape"] == 0
    assert outcome["top_mm_s"] == pytest.approx(63.2456, abs=1e-3)  # √4000
    assert outcome["ramp_mm"] == pytest.approx(2)
    assert outcome["total_s"] == pytest.approx(0.126491, abs=1e-5)


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(7.5)  # 150² / 3000
    assert LESSON.asked(1).answer == pytest.approx(50, rel=1e-6)  # √2500
