"""Numbers by hand: √(rod² - distance²)."""

import pytest

from passo.learn.lessons.delta import EXPERIMENT, LESSON


def test_the_middle_and_a_side():
    outcome = EXPERIMENT.run({})
    assert outcome["middle_mm"] == pytest.approx((180**2 - 81**2) ** 0.5)
    assert outcome["a_mm"] == outcome["b_mm"] == pytest.approx(outcome["c_mm"])
    side = EXPERIMENT.run({"y_mm": 40})
    assert side["a_mm"] == pytest.approx((180**2 - 41**2) ** 0.5)
    # B is at 70.148, -40.5: 70.148² + 80.5² from the nozzle.
    assert side["b_mm"] == pytest.approx((180**2 - 4920.75 - 6480.25) ** 0.5)
    assert side["c_mm"] == pytest.approx(side["b_mm"])


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx((200**2 - 50**2) ** 0.5)  # 193.65
    assert LESSON.asked(1).answer == pytest.approx((250**2 - 81**2) ** 0.5)  # 236.51
