"""Tables of the data sheets: A4988, DRV8825, TMC2208, TMC2209; sin(90°/16) = 0.0980."""

import pytest

from passo.learn.lessons.microstep_jumpers import EXPERIMENT, LESSON


@pytest.mark.parametrize(
    ("driver", "code", "microsteps"),
    [
        ("A4988", (0, 0, 0), 1),
        ("A4988", (1, 0, 0), 2),
        ("A4988", (0, 1, 0), 4),
        ("A4988", (1, 1, 0), 8),
        ("A4988", (1, 1, 1), 16),
        ("A4988", (0, 0, 1), 0),  # not in its data sheet
        ("DRV8825", (0, 0, 1), 16),
        ("DRV8825", (1, 1, 1), 32),
        ("TMC2208", (0, 0, 0), 8),
        ("TMC2208", (1, 0, 0), 2),
        ("TMC2209", (1, 0, 1), 32),
        ("TMC2209", (0, 1, 0), 64),
        ("TMC2209", (1, 1, 0), 16),
    ],
)
def test_jumpers_give_the_microsteps_of_the_data_sheet(driver, code, microsteps):
    given = dict(zip(("ms1", "ms2", "ms3"), code, strict=True)) | {"driver": driver}
    assert EXPERIMENT.run(given)["real"] == microsteps


def test_wrong_jumpers_scale_the_movement():
    outcome = EXPERIMENT.run({"driver": "DRV8825"})  # 32 instead of 16
    assert (outcome["pulses"], outcome["moved_mm"]) == (800, 5)
    assert outcome["step_um"] == pytest.approx(6.25)
    assert EXPERIMENT.run({})["torque_percent"] == pytest.approx(9.80, abs=0.005)


def test_answers():
    assert LESSON.asked(0).answer == 60  # 16 / 8 · 30 mm
    assert LESSON.asked(1).answer == pytest.approx(19.509, abs=1e-3)  # sin(11.25°)
