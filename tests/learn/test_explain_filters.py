"""What `passo explain` shows of shapers and pressure advance."""

from __future__ import annotations

import pytest

from passo import config
from passo.config.load import shipped_text
from passo.config.shapers import impulses
from passo.job.batch.policy import Policy
from passo.learn.explain import explain
from passo.learn.explanation import explanation_text

FILE = "G28\nM302 S0\nG92 E0\nM900 K0.05\nG1 X20 E1 F3000\nG4 P100\nG1 Y20 F6000\n"
SHAPED = '[shaping.x]\ntype = "mzv"\nfrequency_hz = 50.0\n'


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "a.g"
    path.write_text(FILE)
    return path


def explained(path, line, text=SHAPED):
    machine = config.load_text(shipped_text("i3") + text)
    return explain(machine, path, line, Policy())


def test_effects_of_filters_on_a_line_are_shown(path):
    told = explained(path, 5)
    shown = explanation_text(told)
    pulses = impulses("mzv", 50.0, 0.1)
    mean = sum(weight * at for weight, at in pulses)
    accel = abs(told.moves[0].acceleration)
    off_um = 0.5e3 * accel * sum(weight * (at - mean) ** 2 for weight, at in pulses)
    assert "Filters between plan and steps:\n  X: mzv at 50 Hz spreads" in shown
    assert f"while X speeds up by {accel:.0f} mm/s² it is {off_um:.0f} µm off the plan" in shown
    speed = told.moves[0].cruise_speed / 20
    assert f"E: an advance of 0.05 s pushes {0.05 * speed:.4f} mm of filament ahead" in shown
    assert "follows the shapers" not in shown
    assert f"all motors follow the plan {max(10, mean * 1e3):.2f} ms later" in shown


def test_filament_that_follows_shapers_is_shown(path):
    text = shipped_text("i3").replace("[extruders.e]\n", "[extruders.e]\nshaped = true\n") + SHAPED
    shown = explanation_text(explain(config.load_text(text), path, 5, Policy()))
    assert "E: the filament follows the shapers of X and Y" in shown


def test_knees_below_the_speed_of_the_filament_are_shown(path):
    knees = "advance_s = 0.1\nadvance_knees = [[1.0, 0.06], [2.0, 0.02], [50.0, 0.0]]\n"
    text = shipped_text("i3").replace("[extruders.e]\n", "[extruders.e]\n" + knees)
    told = explain(config.load_text(text), path, 5, Policy())
    mm = 0.05 * 1.0 + 0.03 * 1.0 + 0.01 * (told.moves[0].cruise_speed / 20 - 2.0)
    shown = "\n".join(told.filters)
    assert "E: an advance of 0.05 s, 0.03 s above 1 mm/s, 0.01 s above 2 mm/s pushes" in shown
    assert f"pushes {mm:.4f} mm of filament ahead" in shown


def test_only_filters_of_axes_that_move_are_shown(path):
    assert explained(path, 7).filters == ("all motors follow the plan 10.00 ms later",)
    assert explained(path, 7, "").filters == ("all motors follow the plan 10.00 ms later",)


def test_limit_of_jerk_and_its_corners_are_shown(path):
    """In a corner of 90° from a standstill √2·a·w²/48, on the way a·w²/24."""
    text = shipped_text("i3").replace("[limits]", "[limits]\njerk_mm_s3 = 1.5e5")
    told = explain(config.load_text(text), path, 7, Policy())
    accel, box_s = told.moves[0].acceleration, 2 * 3000 / 1.5e5
    off_um = accel * box_s**2 / 24 * 1e3
    shown = "\n".join(told.filters)
    assert f"means over {box_s * 1e3:.1f} ms" in shown
    assert f"the head is {off_um:.0f} µm off the plan" in shown
    assert f"at its end is cut by up to {off_um / 2**0.5:.0f} µm" in shown


def test_steps_are_those_of_the_filtered_line(path):
    shaped, plain = explained(path, 7), explain(config.load("i3"), path, 7, Policy())
    by_motor = {one.motor: one for one in shaped.steps}
    for one in plain.steps:
        assert by_motor[one.motor].count == one.count
    assert by_motor["y"].first_s > shaped.moves[0].start_s + 0.01
