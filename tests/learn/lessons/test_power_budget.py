"""Numbers by hand: 12 V, hotend 48 W (4 A), bed 144 W (12 A), 5 motors of 4 W at 80 %, 10 W."""

import pytest

from passo.learn.lessons.power_budget import EXPERIMENT, LESSON


def test_budget_of_the_default_printer():
    outcome = EXPERIMENT.run({})
    assert outcome["total_w"] == pytest.approx(48 + 144 + 25 + 10)
    assert outcome["total_a"] == pytest.approx(227 / 12)
    assert outcome["supply_w"] == pytest.approx(272.4)
    assert outcome["bed_a"] == pytest.approx(12)
    assert outcome["lost_v"] == pytest.approx(12 * 0.0175 * 2 / 1.5)
    assert outcome["cable_w"] == pytest.approx(3.36)


def test_wrong_voltage_is_four_times_the_power():
    assert EXPERIMENT.run({"supply_v": 24})["real_bed_w"] == pytest.approx(576)
    assert EXPERIMENT.run({"supply_v": 24, "rated_v": 24})["bed_a"] == pytest.approx(6)


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(480)
    assert LESSON.asked(1).answer == pytest.approx(28)  # 20² · 0.0175 · 3 / 0.75
