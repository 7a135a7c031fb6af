"""Numbers by hand: area 3.927 mm², neck of 2.5 mm of steel: 0.0025/(16·3.927e-6) = 39.79 K/W."""

import pytest

from passo.learn.lessons.hotend_and_heat_creep import EXPERIMENT, LESSON


def test_steel_neck_with_a_fan():
    outcome = EXPERIMENT.run({})
    assert outcome["break_k_w"] == pytest.approx(39.789, abs=1e-3)
    assert outcome["sink_k_w"] == pytest.approx(5)
    assert outcome["watts"] == pytest.approx(185 / 44.789, rel=1e-4)
    assert outcome["cold_c"] == pytest.approx(25 + 5 * 4.1305, abs=1e-2)
    assert outcome["creeps"] == 0


def test_without_a_fan_and_with_brass_it_creeps():
    assert EXPERIMENT.run({"fan_percent": 0})["cold_c"] == pytest.approx(
        25 + 185 * 25 / 64.789, abs=0.01
    )
    assert EXPERIMENT.run({"fan_percent": 0})["creeps"] == 1
    assert EXPERIMENT.run({"conductivity": 110})["creeps"] == 1


def test_answers():
    # Half a fan: 0.04 + 0.08 W/K, so 8.333 K/W.
    assert LESSON.asked(0).answer == pytest.approx(25 + 225 * 8.3333 / 48.122, abs=0.01)
    assert LESSON.asked(1).answer == pytest.approx(205 / (90.946 + 5), rel=1e-4)
