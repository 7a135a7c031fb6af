"""Numbers by hand: A = X + Y, B = X - Y; and what Passo's own motors do."""

from pathlib import Path

import pytest

from passo import Machine
from passo.learn.lessons.corexy import EXPERIMENT, LESSON


def test_a_move():
    outcome = EXPERIMENT.run({})
    assert (outcome["a_mm"], outcome["b_mm"], outcome["back_x_mm"]) == (60, 20, 40)
    assert (outcome["a_steps"], outcome["b_steps"]) == (4800, 1600)


def test_passo_moves_its_motors_so(tmp_path: Path):
    file = tmp_path / "move.gcode"
    trace = Machine.load("corexy")
    file.write_text("G28\nG1 X40 Y20 F3000\n")
    there = trace.print(file).steps
    file.write_text("G28\n")
    home = trace.print(file).steps
    assert (there["a"] - home["a"], there["b"] - home["b"]) == (4800, 1600)


def test_answers():
    assert LESSON.asked(0).answer == -2000
    assert LESSON.asked(1).answer == pytest.approx(282.84, abs=0.01)
