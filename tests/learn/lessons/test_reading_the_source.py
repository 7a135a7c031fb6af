"""Numbers by hand: 80 steps/mm, 3000 mm/s², 16 MHz; the wire of the tutorial on one line."""

from math import sqrt

import pytest

from passo.learn.lessons.reading_the_source import EXPERIMENT, LESSON


def test_values_of_the_walk():
    outcome = EXPERIMENT.run({"length_mm": 10, "speed_mm_s": 50})
    assert outcome["steps"] == 800
    # half a step from rest, within the tolerance of 2 µs and its rounding
    assert outcome["first_ms"] == pytest.approx(1000 * sqrt(2 * 0.00625 / 3000), abs=0.003)
    assert outcome["interval"] == outcome["first_ms"] * 16_000
    assert outcome["second_gap"] == outcome["interval"] + outcome["add"]
    assert outcome["commands"] < 30


def test_answers():
    first = LESSON.asked(0)
    assert first.answer == pytest.approx(first.numbers["interval"] / 16_000)
    assert LESSON.asked(1).answer == pytest.approx(32628 - 8655)  # as in passo explain
