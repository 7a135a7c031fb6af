"""Numbers by hand: β = ln(R1/R2) / (1/T1 - 1/T2), T in kelvin."""

from math import exp, log

import pytest

from passo.learn.lessons.thermistor_equations import EXPERIMENT, LESSON


def test_beta_from_two_points():
    outcome = EXPERIMENT.run({})
    beta = log(100_000 / 1642) / (1 / 298.15 - 1 / 423.15)
    assert outcome["hot_ohm"] == pytest.approx(1642)
    assert outcome["beta_k"] == pytest.approx(beta)
    assert outcome["r_inf_ohm"] == pytest.approx(100_000 * exp(-beta / 298.15))


def test_it_is_right_at_its_points_and_wrong_beyond():
    for celsius in (60, 150, 250):
        at_point = EXPERIMENT.run({"hot_c": celsius, "true_c": celsius})
        assert at_point["error_c"] == pytest.approx(0, abs=1e-6)
    far = EXPERIMENT.run({"hot_c": 150, "true_c": 250})
    # By β of 25 and 150 °C the data sheet's 226 Ω of 250 °C is this temperature.
    shown = far["beta_k"] / log(226 / far["r_inf_ohm"]) - 273.15
    assert far["shown_c"] == pytest.approx(shown, abs=0.01)
    assert abs(far["error_c"]) > 1


def test_answers():
    ohm = EXPERIMENT.run({"hot_c": 100})["hot_ohm"]
    wanted = log(100_000 / ohm) / (1 / 298.15 - 1 / 373.15)
    assert LESSON.asked(0).answer == pytest.approx(wanted)
    assert abs(LESSON.asked(1).answer) > 3
