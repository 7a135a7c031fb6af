"""Numbers by hand: R = δ·s/(1-s), v² = a·R. A right angle has s = 0.7071, so R = 2.414 δ."""

import pytest

from passo.learn.lessons.corner import EXPERIMENT, LESSON


def test_a_right_angle():
    outcome = EXPERIMENT.run({})
    assert outcome["radius_mm"] == pytest.approx(0.048284, abs=1e-6)
    assert outcome["corner_mm_s"] == pytest.approx(12.0355, abs=1e-3)  # √(3000·0.048284)


@pytest.mark.parametrize("turn_deg", [10, 45, 90, 135, 170])
def test_the_circle_passes_by_the_deviation(turn_deg: float):
    outcome = EXPERIMENT.run({"turn_deg": turn_deg, "deviation_mm": 0.05})
    assert outcome["nearest_mm"] == pytest.approx(0.05)
    wanted = (3000 * outcome["radius_mm"]) ** 0.5
    assert outcome["corner_mm_s"] == pytest.approx(wanted, rel=1e-4)


def test_answers():
    # s = sin 60° = 0.866025, R = 0.05·6.4641 = 0.323205, v = √646.41
    assert LESSON.asked(0).answer == pytest.approx(25.4246, abs=1e-3)
    assert LESSON.asked(1).answer == pytest.approx(2 * 12.0355, abs=2e-3)
