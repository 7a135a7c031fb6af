"""Numbers by hand: filament ahead = K·v_e; the extruder needs v_e + K·a_e."""

import pytest

from passo.learn.lessons.pressure_in_the_nozzle import EXPERIMENT, LESSON

PER_MM = (0.2 * 0.25 + 0.0314159) / 2.40528  # rectangle and round sides, by the filament


def test_advance():
    outcome = EXPERIMENT.run({"advance_s": 0.05})
    assert outcome["per_mm"] == pytest.approx(PER_MM, rel=1e-5)
    assert outcome["e_mm_s"] == pytest.approx(100 * PER_MM, rel=1e-5)
    assert outcome["extra_mm"] == pytest.approx(0.05 * 100 * PER_MM, rel=1e-5)
    assert outcome["push_mm_s"] == pytest.approx((100 + 0.05 * 2000) * PER_MM, rel=1e-5)


def test_the_advance_of_the_nozzle_is_the_best():
    lag = {k: EXPERIMENT.run({"advance_s": k})["lag_mm3"] for k in (0.0, 0.025, 0.05, 0.075, 0.1)}
    assert min(lag, key=lag.__getitem__) == 0.05
    assert lag[0.05] < 0.1 * lag[0.0]


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(0.04 * 150 * PER_MM, rel=1e-5)
    assert LESSON.asked(1).answer == pytest.approx((100 + 0.06 * 3000) * PER_MM, rel=1e-5)
