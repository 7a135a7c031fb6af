"""Numbers by hand: 0.0123 mm at 80 steps/mm is 0.984 steps; a thousand of them are 984."""

from pathlib import Path

import pytest

from passo import Machine
from passo.learn.lessons.float_against_integer import EXPERIMENT, LESSON


def test_a_thousand_tiny_moves():
    outcome = EXPERIMENT.run({})
    assert outcome["each"] == pytest.approx(0.984)
    assert outcome["cut_steps"] == 0
    assert outcome["cut_error_mm"] == pytest.approx(-12.3)
    assert outcome["rounded_steps"] == 1000
    assert outcome["rounded_error_mm"] == pytest.approx(0.2)  # 12.5 - 12.3 mm
    assert outcome["exact_steps"] == 984


def test_passo_takes_these_steps(tmp_path: Path):
    file = tmp_path / "tiny.gcode"
    file.write_text("G28\nG91\n" + "G1 X0.0123 F600\n" * 1000)
    assert Machine.load("i3").print(file).steps["x"] == 984


def test_answers():
    assert LESSON.asked(0).answer == 500
    assert LESSON.asked(1).answer == 496  # 6.2 mm · 80
