"""Numbers by hand: 80 steps/mm, 25 µs for an interrupt, 1.5 ms for a line."""

import pytest

from passo.learn.lessons.interrupts_and_queue import EXPERIMENT, LESSON


def test_load_and_queue():
    outcome = EXPERIMENT.run({"speed_mm_s": 100, "segment_mm": 0.5})
    assert outcome["interval_us"] == pytest.approx(125)  # 8000 steps/s
    assert outcome["steps_percent"] == pytest.approx(20)
    assert outcome["plan_percent"] == pytest.approx(30)  # 1.5 of 5 ms
    assert outcome["queue_ms"] == pytest.approx(80)
    assert outcome["stands_ms"] == pytest.approx(220)
    assert outcome["passo_stands_ms"] == 0


def test_an_interrupt_that_blocks_delays_the_steps_after_it():
    assert EXPERIMENT.run({})["late_steps"] == 0
    outcome = EXPERIMENT.run({"blocked_us": 1000})
    # It ends 1025 µs after its step, 900 µs after the next one; each further step makes up 100 µs.
    assert outcome["latest_us"] == pytest.approx(900)
    assert outcome["late_steps"] == 9  # 900, 800, … 100 µs


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(40)  # 16 · 2.5 ms
    assert LESSON.asked(1).answer == pytest.approx(30)  # 12000 · 25 µs
    assert LESSON.asked(2).answer == pytest.approx(300)  # 500 - 16 · 12.5 ms
