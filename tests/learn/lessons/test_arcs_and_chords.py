"""Numbers by hand: Pythagoras, and Passo's bound of 0.0045 mm."""

import pytest

from passo.learn.lessons.arcs_and_chords import EXPERIMENT, LESSON


def test_a_chord_on_a_circle():
    outcome = EXPERIMENT.run({"radius_mm": 5, "chord_mm": 5})
    assert outcome["error_mm"] == pytest.approx(5 - 18.75**0.5)
    assert outcome["count"] == 7  # 31.4 / 5


@pytest.mark.parametrize("radius_mm", [1, 2.5, 20, 80])
def test_passo_stays_near_the_circle(radius_mm: float):
    outcome = EXPERIMENT.run({"radius_mm": radius_mm})
    assert 0.0035 < outcome["passo_error_mm"] <= 0.0045
    assert outcome["passo_count"] == pytest.approx(3.14159 / (2 * 0.0045 / radius_mm) ** 0.5, abs=1)


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(5 - 24**0.5)
    assert LESSON.asked(1).answer == pytest.approx(4 / 160, rel=1e-3)
