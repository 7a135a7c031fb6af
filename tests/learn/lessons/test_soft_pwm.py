"""Numbers by hand: 16 MHz / 64 / 64 = 3906.25 Hz, 256 counts."""

import pytest

from passo.learn.lessons.soft_pwm import EXPERIMENT, LESSON


@pytest.mark.parametrize(
    ("speed", "hertz", "levels"),
    [(0, 15.26, 256), (1, 30.5, 128), (2, 61.0, 64), (3, 122, 32), (4, 244, 16)],
)
def test_frequency_and_levels_of_each_speed(speed, hertz, levels):
    outcome = EXPERIMENT.run({"speed": speed})
    assert outcome["frequency_hz"] == pytest.approx(hertz, rel=2e-3)
    assert outcome["levels"] == levels


def test_duty_cycle_is_rounded_to_a_level():
    assert EXPERIMENT.run({"speed": 4})["real_percent"] == 37.5  # 6.4 of 16 levels
    assert EXPERIMENT.run({"duty_percent": 0})["mean_w"] == 0
    assert EXPERIMENT.run({"duty_percent": 100})["mean_w"] == 48


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(122.0703, abs=1e-4)
    assert LESSON.asked(1).answer == 68.75  # 11 of 16
    assert LESSON.asked(2).answer == pytest.approx(0.262144)  # 4 °C/s · 0.25 · 0.262144 s
