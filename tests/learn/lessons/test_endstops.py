"""NC with pull-up: closed is 0 V, pressed or broken is 5 V. Expectations from the truth table."""

import pytest

from passo.learn.lessons.endstops import EXPERIMENT, LESSON

HOMES, REFUSES, CRASHES = 0, 1, 2


@pytest.mark.parametrize(
    ("contact", "wire", "inverted", "end"),
    [
        ("NC", "intact", 0, HOMES),
        ("NC", "broken", 0, REFUSES),
        ("NC", "short", 0, CRASHES),
        ("NC", "intact", 1, REFUSES),
        ("NO", "intact", 1, HOMES),
        ("NO", "broken", 1, CRASHES),
        ("NO", "short", 1, REFUSES),
        ("NO", "intact", 0, REFUSES),
    ],
)
def test_homing_with_each_contact_wire_and_pin(contact, wire, inverted, end):
    outcome = EXPERIMENT.run({"contact": contact, "wire": wire, "inverted": inverted})
    assert outcome["end"] == end
    assert outcome["push_mm"] == pytest.approx(200 if end == CRASHES else 0)  # 1.2 · 200 - 40


def test_voltage_and_current_of_the_contact():
    outcome = EXPERIMENT.run({"pull_up_ohm": 1000})
    assert (outcome["volt"], outcome["current_ma"]) == (0, 5)
    outcome = EXPERIMENT.run({"pressed": 1})
    assert (outcome["volt"], outcome["current_ma"], outcome["triggered"]) == (5, 0, 1)


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(330)  # 1.2 · 300 - 30
    assert LESSON.asked(1).answer == REFUSES
