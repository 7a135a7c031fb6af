"""Numbers by hand: v² = 2·a·s; a queue of one move knows only its own end."""

import pytest

from passo.learn.lessons.look_ahead import EXPERIMENT, LESSON


def test_one_known_move_makes_triangles():
    outcome = EXPERIMENT.run({"known": 1, "length_mm": 0.4})
    assert outcome["top_mm_s"] == pytest.approx(20)  # √(1000·0.4)
    assert outcome["total_s"] == pytest.approx(40 * 2 * 20 / 1000)


def test_a_queue_of_four_moves():
    # Three further moves of 0.5 mm after each: v² = 2·1000·1.5, and half a move above that.
    assert EXPERIMENT.run({})["top_mm_s"] == pytest.approx(3500**0.5)


def test_a_long_queue_is_one_long_move():
    outcome = EXPERIMENT.run({"known": 256})
    assert outcome["top_mm_s"] == pytest.approx(100)
    assert outcome["total_s"] == pytest.approx(20 / 100 + 100 / 1000)  # s/v + v/a
    assert outcome["slower"] == pytest.approx(1)
    assert outcome["stop_mm"] == pytest.approx(5)
    assert outcome["needed"] == 10


def test_answers():
    assert LESSON.asked(0).answer == 9  # 60²/2000 = 1.8 mm
    assert LESSON.asked(1).answer == pytest.approx(30)  # √900
