"""Steps by hand: 5 fast and 2 slow ones give the errors 0.4, 0.8 (step), 0.2, 0.6 (step), 0."""

import pytest

from passo.learn.lessons.bresenham import EXPERIMENT, LESSON


def test_a_line_of_five_and_two():
    outcome = EXPERIMENT.run({"fast_steps": 5, "slow_steps": 2, "rate_hz": 1000})
    assert outcome.tables[0].rows == [
        ["1", "0.40", "", "0.40"],
        ["2", "0.80", "+1", "-0.20"],
        ["3", "0.20", "", "0.20"],
        ["4", "0.60", "+1", "-0.40"],
        ["5", "0.00", "", "0.00"],
    ]
    assert outcome["first_at"] == 2
    assert outcome["exact_gap_ms"] == pytest.approx(2.5)
    assert outcome["short_gap_ms"] == outcome["long_gap_ms"] == pytest.approx(2)
    # Exact: at 1.25 and 3.75 ms. Bresenham: at 1.5 and 3.5 ms.
    assert outcome["late_ms"] == pytest.approx(0.25)


def test_intervals_jump_between_two_values():
    outcome = EXPERIMENT.run({})
    assert outcome["exact_gap_ms"] == pytest.approx(2.5)
    assert outcome["short_gap_ms"] == pytest.approx(2)
    assert outcome["long_gap_ms"] == pytest.approx(3)


def test_answers():
    assert LESSON.asked(0).answer == 4  # 4/30, 8/30, 12/30, 16/30
    assert LESSON.asked(1).answer == pytest.approx(1.25)  # 25 ms / 20
