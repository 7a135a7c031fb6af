"""Numbers by hand: 400 °C rise, 160 s, 4 s of sensor delay, room of 25 °C."""

import pytest

from passo.learn.lessons.on_off_against_pid import EXPERIMENT, LESSON


def test_on_off_swings_more_than_its_hysteresis():
    outcome = EXPERIMENT.run({})
    assert outcome["rise_c_s"] == pytest.approx(1.40625)  # (400 - 175) / 160
    assert outcome["late_c"] == pytest.approx(5.625)
    assert 2 < outcome["swing_c"] < 12
    assert outcome["calm_c"] < 0.5


def test_a_wide_hysteresis_switches_less():
    narrow, wide = EXPERIMENT.run({}), EXPERIMENT.run({"hysteresis_c": 5})
    assert wide["times"] < 0.5 * narrow["times"]
    assert wide["swing_c"] > narrow["swing_c"]


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(2)  # (400 - 80) / 160
    assert LESSON.asked(1).answer == pytest.approx(5)  # 200/160 · 4
