"""Numbers by hand: 200 full steps, 16 microsteps, 3200 steps in a rotation."""

import pytest

from passo.learn.calculators.steps_per_mm import CALCULATOR
from passo.learn.lessons.steps_per_mm import LESSON


@pytest.mark.parametrize(
    ("given", "steps_per_mm"),
    [
        ({}, 80),  # 3200 / (20 · 2 mm)
        ({"drive": "screw"}, 400),  # 3200 / 8 mm
        ({"drive": "screw", "lead_mm": 0.8}, 4000),  # M5
        ({"drive": "screw", "lead_mm": 1.25}, 2560),  # M8
        ({"full_steps": 400, "microsteps": 32}, 320),
        ({"gear_ratio": 3}, 240),
    ],
)
def test_steps_per_mm(given, steps_per_mm):
    outcome = CALCULATOR.run(given)
    assert outcome["steps_per_mm"] == pytest.approx(steps_per_mm, rel=1e-12)
    assert outcome["step_um"] == pytest.approx(1000 / steps_per_mm, rel=1e-12)


def test_answers():
    assert [LESSON.asked(i).answer for i in range(2)] == pytest.approx([100, 2560])
    first = LESSON.asked(0)
    assert [m.value(first.numbers) for m in first.question.mistakes] == [6.25, 200, 0.01]
