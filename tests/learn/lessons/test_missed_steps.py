"""Numbers by hand: 0.35 N·m at 2 A in both coils are 0.35 / (√2 · 2) N·m for each ampere."""

from math import asin, degrees, pi, sqrt

import pytest

from passo.learn.lessons.missed_steps import EXPERIMENT, LESSON
from passo.learn.stepper_model import Drive

PER_A = 0.35 / (2 * sqrt(2))


def test_forces_at_low_speed():
    outcome = EXPERIMENT.run({"current_a": 1, "drag_n": 5})
    assert outcome["holding_nmm"] == pytest.approx(1000 * PER_A)
    pull_out_n = PER_A / (0.04 / (2 * pi))
    assert pull_out_n == pytest.approx(19.438, abs=1e-3)
    assert outcome["pull_out_n"] == pytest.approx(pull_out_n)
    assert outcome["load_deg"] == pytest.approx(degrees(asin(5 / pull_out_n)))
    # 0.8 mm are 360°; acceleration of 0.4 kg and of the rotor: 5.4e-6 kg·m² / r²
    assert outcome["lag_mm"] == pytest.approx(0.8 * 14.906 / 360, abs=1e-4)
    assert EXPERIMENT.run({"drag_n": 0, "obstacle_n": 0})["needed_n"] == pytest.approx(
        3.0 * (0.4 + 5.4e-6 / (0.04 / (2 * pi)) ** 2)
    )


def test_inductance_and_induced_voltage_limit_the_torque_at_speed():
    # 12 V, 100 rad/s: Z = |1.1 + 14j| Ω = 14.043, 12/Z = 0.8545 A; 12.374 V induced take 0.0690 A
    found = Drive(1.0, 12.0, 0.4, 5.0).pull_out_nm(100.0)
    assert found == pytest.approx(PER_A * (0.8545 - 0.0690), rel=1e-3)
    assert Drive(1.0, 24.0, 0.4, 5.0).pull_out_nm(100.0) == pytest.approx(PER_A)


@pytest.mark.parametrize(
    ("given", "loses"),
    [
        ({"obstacle_n": 10}, False),  # 15 N of 19.4
        ({"obstacle_n": 20}, True),
        ({"obstacle_n": 20, "current_a": 2}, False),
        ({"acceleration_mm_s2": 20_000, "obstacle_n": 0}, False),  # 15.7 N
        ({"acceleration_mm_s2": 40_000, "obstacle_n": 0}, True),  # 26.3 N
    ],
)
def test_steps_are_lost_beyond_the_pull_out_force(given, loses):
    outcome = EXPERIMENT.run(given)
    assert (outcome["lost_steps"] > 0) == loses
    assert outcome["lost_steps"] % 4 == 0
    assert outcome["shift_mm"] == pytest.approx(0.2 * outcome["lost_steps"])


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(29.157, abs=1e-3)  # 1.5 · 19.438
    assert LESSON.asked(1).answer == pytest.approx(47.3, abs=0.05)  # asin(10 / 13.607)
    assert LESSON.asked(2).answer == pytest.approx(5 * LESSON.asked(2).numbers["shift_mm"])
