"""Numbers by hand: the classic rule is 0.6 Ku, 1.2 Ku/Tu, 0.075 Ku Tu."""

import pytest

from passo.learn.lessons.tuning_rules import EXPERIMENT, LESSON


def test_the_classic_rule():
    outcome = EXPERIMENT.run({})
    assert [outcome[name] for name in ("kp", "ki", "kd")] == pytest.approx([48, 4, 144])


def test_every_rule_is_in_the_table():
    rows = EXPERIMENT.run({}).tables[0].rows
    assert [str(row[0])[:2] for row in rows] == ["R0", "R1", "R2", "R3", "R4"]
    assert [row[1] for row in rows] == ["48", "26.4", "16", "56", "36.36"]


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(1.5)
    assert LESSON.asked(1).answer == pytest.approx(60)
