"""Numbers by hand: G92 adds first - called to all later coordinates; v²/2a to stop."""

import pytest

from passo.learn.lessons.homing_and_coordinates import EXPERIMENT, LESSON


@pytest.mark.parametrize(
    ("first", "called", "second", "machine"), [(50, 0, 10, 60), (50, 50, 12, 12), (60, 20, 45, 85)]
)
def test_the_machine_after_g92(first: float, called: float, second: float, machine: float):
    outcome = EXPERIMENT.run({"first_mm": first, "called_mm": called, "second_mm": second})
    assert outcome["machine_mm"] == pytest.approx(machine)


def test_the_way_beyond_a_switch():
    outcome = EXPERIMENT.run({})
    assert outcome["past_mm"] == pytest.approx(0.8)  # 40²/2000
    assert outcome["late_mm"] == pytest.approx(0.0125)  # a step


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(95)  # 80 + (40 - 25)
    assert LESSON.asked(1).answer == pytest.approx(1.2)  # 3600 / 3000
