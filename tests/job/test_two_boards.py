"""One print on two boards: the same steps as on one board, at the same time."""

import math
import random

import pytest
from tests.support.two_boards import demo, one_board, printed, two_boards

from passo.printer.setup.boards import board_description
from passo.simulator import Cable

STEPPERS = ("x", "y", "z", "e")
LENGTHS = [0.3 + i / 10_000 for i in range(4000)]


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return demo(tmp_path_factory.mktemp("demo"))


@pytest.fixture(scope="module")
def alone(path):
    with pytest.MonkeyPatch.context() as patch:
        return printed(patch, one_board(), path)


@pytest.fixture
def spiral(tmp_path):
    """Two minutes, without a heater."""
    lines = ["M302 P1", "G28", "G1 Z5 F300", "G92 E0"]
    for i in range(1500):
        r, a = 5 + i / 40, i / 5
        x, y = 100 + r * math.cos(a), 100 + r * math.sin(a)
        lines.append(f"G1 X{x:.3f} Y{y:.3f} Z{5 + i / 400:.3f} E{i / 20:.4f} F3000")
        if i % 100 == 99:
            lines += [f"G1 E{i / 20 - 1:.4f} F1800", f"G1 E{i / 20:.4f}"]
    path = tmp_path / "spiral.gcode"
    path.write_text("\n".join(lines) + "\n")
    return path


def test_without_drift_every_edge_is_that_of_one_board(monkeypatch, path, alone):
    both = printed(monkeypatch, two_boards(), path)
    assert both.result.errors == []
    assert both.result.final_steps == alone.result.final_steps
    assert both.steps == alone.steps
    assert both.outputs == alone.outputs
    assert both.result.queue_step_commands == alone.result.queue_step_commands


@pytest.mark.parametrize("ppm", [-100, 100])
def test_a_board_whose_clock_drifts_steps_in_time(monkeypatch, path, alone, ppm):
    machine = two_boards(f"drift_ppm = {ppm}.0", "start_s = 1234.5")
    both = printed(monkeypatch, machine, path)
    assert both.result.errors == []
    assert both.result.print_time_s > 900
    assert both.result.final_steps == alone.result.final_steps
    assert max(both.skew_us(alone, name) for name in "xy") == 0
    # As much as a step is rounded by, and a tick.
    assert max(both.skew_us(alone, name) for name in "ze") <= 1 + 1 / 16
    assert both.outputs == alone.outputs
    # Drivers take a step in 2 us; rounding never brings two closer than that.
    assert min(both.gap_us(name) for name in "ze") >= 2 - 1 / 16
    # Rounding costs few commands.
    assert both.result.queue_step_commands < 1.02 * alone.result.queue_step_commands


@pytest.mark.parametrize("ppm", [-100, 100])
@pytest.mark.parametrize(
    ("jitter_us", "skew_us"), [(20, 2.5), (100, 3), (200, 4.5), (1000, 12), (5000, 25)]
)
def test_links_that_answer_when_they_like_keep_the_skew_small(
    monkeypatch, spiral, jitter_us, skew_us, ppm
):
    alone = printed(monkeypatch, one_board(), spiral)
    machine = two_boards(f"drift_ppm = {ppm}.0", "start_s = 1234.5")
    both = printed(monkeypatch, machine, spiral, Cable(200e-6, jitter_us * 1e-6))
    assert both.result.errors == []
    assert max(both.skew_us(alone, name) for name in "xy") == 0
    skew = max(both.skew_us(alone, name) for name in "ze")
    assert skew <= skew_us


@pytest.mark.parametrize("firmware", ["virtual", "passo"])
def test_commands_do_not_wait_for_all_parts_of_a_long_one(monkeypatch, tmp_path, firmware):
    """X moves evenly, in commands of 60 ms that become several there; the extruder does not."""
    moves = [f"G1 X{4 * i} E{0.05 if i % 2 else 0.02}" for i in range(1, 60)]
    path = tmp_path / "even.gcode"
    path.write_text("\n".join(["M302 P1", "G92 X0 Y0 Z0", "M83", "G1 F4800", *moves]) + "\n")
    words = {'socket = "X"': 'socket = "tool:X"'}
    machine = two_boards("drift_ppm = 100.0", "start_s = 3.5", firmware=firmware, **words)
    both = printed(monkeypatch, machine, path, Cable(100e-6, 50e-6))
    assert both.result.final_steps["x"] == 59 * 4 * 80
    assert both.slack_s["tool"] > 0.12


@pytest.mark.parametrize("ppm", [-100, 100])
def test_a_motor_turns_no_sooner_on_a_board_whose_clock_drifts(monkeypatch, tmp_path, ppm):
    """Its driver wants the direction so long before the step; rounding takes nothing of that."""
    keys = {
        "[steppers.e]": "[steppers.e]\ndirection_setup_us = 157.3",
        "[extruders.e]": "[extruders.e]\njerk_mm_s = 40.0",
    }
    numbers = random.Random(1)
    there_and_back = [f"G1 E{e:.4f}\nG1 E-{e:.4f}" for e in numbers.choices(LENGTHS, k=2500)]
    path = tmp_path / "turns.gcode"
    path.write_text("\n".join(["M302 P1", "M83", "G1 F2100", *there_and_back]) + "\n")
    machine = two_boards(f"drift_ppm = {ppm}.0", "start_s = 1234.5", **keys)
    both = printed(monkeypatch, machine, path)
    motor = next(s for s in board_description(machine, "tool").steppers if s.name == "e")
    assert abs(both.turn_us("e") * 16 - motor.turning_ticks) <= 1


def test_the_stream_of_each_board_does_not_depend_on_its_clock(monkeypatch, spiral):
    steady = printed(monkeypatch, two_boards(), spiral).result
    drifting = two_boards("drift_ppm = -80.0", "start_s = 3.0")
    shaken = printed(monkeypatch, drifting, spiral, Cable(100e-6, 50e-6)).result
    assert shaken.stream_hash == steady.stream_hash
    assert "-" in steady.stream_hash


def test_boards_of_other_frequencies_keep_time(monkeypatch, spiral):
    alone = printed(monkeypatch, one_board(), spiral)
    machine = two_boards("drift_ppm = 60.0", "start_s = 50.0", base="radds")
    assert machine.boards["tool"].clock_hz == 42_000_000
    both = printed(monkeypatch, machine, spiral)
    assert both.result.errors == []
    assert max(both.skew_us(alone, name) for name in "ze") <= 1 + 2 / 16


def test_firmware_on_both_boards_does_the_same(monkeypatch, spiral):
    keys = ("drift_ppm = 100.0", "start_s = 20.0")
    model = printed(monkeypatch, two_boards(*keys), spiral)
    firmware = printed(monkeypatch, two_boards(*keys, firmware="passo"), spiral)
    assert firmware.result.print_time_s > 120
    assert firmware.steps == model.steps
    assert firmware.outputs == model.outputs
    assert firmware.result.errors == []
