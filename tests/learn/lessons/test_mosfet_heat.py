"""Worked examples: STP55NF06L 18 mΩ, IRLB8743 3.5 mΩ, IRLB3034 1.7 mΩ, 62.5 °C/W, air of 25 °C."""

import pytest

from passo.learn.lessons.mosfet_heat import CALCULATOR, LESSON


@pytest.mark.parametrize(
    ("part", "current_a", "power_w", "junction_c"),
    [
        ("STP55NF06L", 4, 0.288, 43),
        ("STP55NF06L", 12, 2.592, 187),
        ("IRLB8743", 12, 0.504, 56.5),
        ("IRLB3034", 12, 0.2448, 40.3),
    ],
)
def test_worked_examples(part, current_a, power_w, junction_c):
    outcome = CALCULATOR.run({"part": part, "current_a": current_a})
    assert outcome["power_w"] == pytest.approx(power_w)
    assert outcome["junction_c"] == pytest.approx(junction_c)


def test_resistance_that_grows_settles_where_heat_in_equals_heat_out():
    hot_c = CALCULATOR.run({"part": "IRLB8743"})["hot_junction_c"]
    made_w = 12**2 * 0.0035 * (1 + 0.006 * (hot_c - 25))
    assert made_w * 62.5 == pytest.approx(hot_c - 25)
    assert hot_c == pytest.approx(63.8, abs=0.05)


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(102)  # 30 + 64 · 0.018 · 62.5
    assert LESSON.asked(1).answer == pytest.approx(37.57, abs=0.01)  # √(150 / 62.5 / 0.0017)
