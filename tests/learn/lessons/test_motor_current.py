"""Numbers by hand: A4988 8 · I · R, DRV8825 5 · I · R, RMS = peak / √2."""

import pytest

from passo.learn.lessons.motor_current import CALCULATOR, LESSON


@pytest.mark.parametrize(
    ("given", "volt"),
    [
        ({}, 0.952),  # 8 · 1.19 · 0.1
        ({"driver": "DRV8825"}, 0.595),
        ({"sense_ohm": 0.05}, 0.476),
        ({"driver": "TMC2209", "sense_ohm": 0.11, "percent": 100}, 1.7265625),  # 1.7·2.5·0.13/0.32
    ],
)
def test_reference_voltage_of_each_driver(given, volt):
    assert CALCULATOR.run(given)["reference_v"] == pytest.approx(volt)


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(0.6528)  # 8 · 1.2 · 0.068
    assert LESSON.asked(1).answer == pytest.approx(2.88)  # 1.2² · 2
