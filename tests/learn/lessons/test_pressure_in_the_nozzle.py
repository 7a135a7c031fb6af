"""Numbers by hand: filament ahead = K·v_e; the extruder needs v_e + K·a_e."""

import pytest

from passo.learn.lessons.pressure_in_the_nozzle import EXPERIMENT, LESSON


def test_filament_of_the_line():
    # 0.45 · 0.2 mm² of line, without its round ends, by π/4·1.75² of filament
    assert EXPERIMENT.run({})["per_mm"] == pytest.approx(0.09 / 2.405, abs=1e-4)


def test_advance():
    outcome = EXPERIMENT.run({"advance_s": 0.05})
    assert outcome["e_mm_s"] == pytest.approx(3.74)
    assert outcome["extra_mm"] == pytest.approx(0.187)
    assert outcome["push_mm_s"] == pytest.approx(3.74 + 0.05 * 74.8)


def test_the_advance_of_the_nozzle_is_the_best():
    lag = {k: EXPERIMENT.run({"advance_s": k})["lag_mm3"] for k in (0.0, 0.025, 0.05, 0.075, 0.1)}
    assert min(lag, key=lag.__getitem__) == 0.05
    assert lag[0.05] < 0.1 * lag[0.0]


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(0.2244)  # 0.04 · 150 · 0.0374
    assert LESSON.asked(1).answer == pytest.approx(3.74 + 0.06 * 3000 * 0.0374)
