"""The right numbers, worked by hand or from other lessons."""

import pytest

from passo.learn.lessons.known_errors import EXPERIMENT, LESSON


@pytest.mark.parametrize(
    ("claim", "claimed", "right"),
    [
        ("belt", 32_000, 800),
        ("screw", 1_280_000, 4000),
        ("beta", 4479, 4435.83),
        ("fahrenheit", 93.33, 392),
        ("truncation", 0, 984),
        ("mosfet", 56.5, 63.84),
        ("thermistor", 1 / 473.15, 200),
    ],
)
def test_claims_and_right_numbers(claim, claimed, right):
    outcome = EXPERIMENT.run({"claim": claim})
    assert outcome["claimed"] == pytest.approx(claimed, abs=0.01)
    assert outcome["right"] == pytest.approx(right, abs=0.01)


def test_answers():
    assert [LESSON.asked(i).answer for i in range(3)] == pytest.approx(
        [10_000, 4435.83, 140], abs=0.01
    )
