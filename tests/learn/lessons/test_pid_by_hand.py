"""Numbers by hand: 400 °C at full power, room of 25 °C; power = Kp·error/255."""

import pytest

from passo.learn.lessons.pid_by_hand import EXPERIMENT, LESSON


def test_p_alone_stays_below():
    outcome = EXPERIMENT.run({})
    assert outcome["steady_c"] == pytest.approx(175 / (1 + 4000 / 255))
    assert outcome["last_c"] == pytest.approx(200 - outcome["steady_c"], abs=0.6)
    assert outcome["held_percent"] == pytest.approx(43.75)


def test_d_brakes_what_strong_p_overshoots():
    assert EXPERIMENT.run({"kp": 200})["over_c"] > 1
    assert EXPERIMENT.run({"kp": 200, "kd": 200})["over_c"] < 0.1


def test_an_unbounded_sum_winds_up_and_passo_does_not():
    outcome = EXPERIMENT.run({"kp": 20, "ki": 0.1})
    assert outcome["over_c"] > 20
    assert outcome["passo_over_c"] < 2


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(200 / (1 + 8000 / 255))  # 6.18
    assert LESSON.asked(1).answer == pytest.approx(55)  # 220/400
