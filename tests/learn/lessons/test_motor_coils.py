"""Numbers by hand: a full step is 90° of the currents and 1.8° of the shaft."""

from math import sqrt

import pytest

from passo.learn.lessons.motor_coils import EXPERIMENT, LESSON


def test_half_a_full_step_leaves_the_current_to_one_coil():
    outcome = EXPERIMENT.run({"microsteps": 16, "position": 8, "current_a": 1.2})
    assert outcome["coil_a_a"] == pytest.approx(0, abs=1e-12)
    assert outcome["coil_b_a"] == pytest.approx(1.2)
    assert outcome["rotor_deg"] == pytest.approx(0.9)


def test_full_steps_have_both_coils_on():
    for position, signs in enumerate([(1, 1), (-1, 1), (-1, -1), (1, -1)]):
        outcome = EXPERIMENT.run({"microsteps": 1, "position": position, "current_a": 1})
        share = 1 / sqrt(2)
        assert (outcome["coil_a_a"], outcome["coil_b_a"]) == pytest.approx(
            (signs[0] * share, signs[1] * share)
        )


@pytest.mark.parametrize(
    ("wiring", "rotor_deg"), [("normal", 1.8), ("one", -1.8), ("both", 1.8), ("open", 0)]
)
def test_direction_of_each_wiring(wiring, rotor_deg):
    outcome = EXPERIMENT.run({"position": 16, "wiring": wiring})
    assert outcome["rotor_deg"] == pytest.approx(rotor_deg)


def test_answers():
    assert [LESSON.asked(i).answer for i in range(3)] == pytest.approx(
        [0.292635, 2.7, 1],
        abs=1e-5,  # 1.5 · cos 78.75°; 48/32 · 1.8°
    )
