"""Motion sensors of the filament, sensors of several tools, and sensors on other boards."""

from __future__ import annotations

import pytest
from tests.job.test_lost_link import break_link
from tests.support.filament_printer import ENDED, INPUT, printing, turns, with_sensor
from tests.support.scenario import Scenario
from tests.support.two_boards import two_boards

from passo.config.inputs import FilamentSensor
from passo.config.load import load_text, shipped_text
from passo.job.live.job_state import JobState

MOTION = 'kind = "motion"\nlength_mm = {}'
STUCK = "ended or is stuck"
THICK = "G1 X{x} Y{y} E2 F1500"


def test_moving_filament_never_pauses_a_print_with_retractions_and_arcs(tmp_path):
    lines = [line for turn in turns(15, THICK) for line in (turn, "G1 E-5 F1800", "G1 E5 F1800")]
    lines += ["G1 X60 Y60 F3000", *["G2 X60 Y60 I10 J0 E4"] * 4]
    with Scenario(with_sensor(MOTION.format(3.0)), card=str(tmp_path)) as s:
        printing(s, tmp_path, *lines)
        s.host.expect("^Done printing file$", 200)
        assert not [line for line in s.host.heard if ENDED in line]
        assert s.positions()["e"] == pytest.approx(46, abs=0.02)


def test_stuck_filament_pauses_after_the_length_that_was_pushed(tmp_path):
    with Scenario(with_sensor(MOTION.format(7.0)), card=str(tmp_path)) as s:
        printing(s, tmp_path, *turns(60, THICK))
        s.passes(8)
        s.host.ok("SIMULATE_FAULT NAME=filament-roll VALUE=out")
        at_mm = s.positions()["e"]
        s.host.expect(STUCK, 60)
        pushed = s.positions()["e"] - at_mm
        speed_mm_s = 2 / 20 * 1500 / 60
        # the last pulse was at most one edge, 7/4 mm, before
        assert 7 - 7 / 4 <= pushed <= 7 + speed_mm_s * 0.25
        s.passes(5)
        assert s.printer.status.read().filament_sensors["roll"].detected is False
        s.host.ok("SIMULATE_FAULT NAME=filament-roll VALUE=none")
        s.host.ok("M24")
        s.host.expect("^Done printing file$", 400)
        assert s.positions()["e"] == pytest.approx(120, abs=0.02)
        assert sum(STUCK in line and "action" not in line for line in s.host.heard) == 1


def test_retraction_without_pulses_is_no_loss(tmp_path):
    lines = [*turns(2, THICK), *["G1 E-5 F600", "G1 E5 F600"] * 6]
    with Scenario(with_sensor(MOTION.format(7.0)), card=str(tmp_path)) as s:
        s.board.force_input(INPUT, True)  # no pulse at all
        printing(s, tmp_path, *lines)
        s.host.expect("^Done printing file$", 200)
        assert not [line for line in s.host.heard if ENDED in line]


def test_resumed_print_is_not_paused_by_filament_that_was_loaded(tmp_path):
    with Scenario(with_sensor(MOTION.format(7.0)), card=str(tmp_path)) as s:
        printing(s, tmp_path, *turns(20, THICK))
        s.passes(8)
        s.host.ok("M25")
        s.passes(8)
        s.board.force_input(INPUT, True)
        s.host.ok("M83")
        s.host.ok("G1 E30 F600")
        s.host.ok("M400", 30)
        s.board.force_input(INPUT, None)
        s.host.ok("M24")
        s.host.expect("^Done printing file$", 200)
        assert not [line for line in s.host.heard if ENDED in line]


TWO_TOOLS = """
[filament_sensors.left]
pin = "^D32"
extruder = "e"
[filament_sensors.right]
pin = "^D45"
extruder = "e1"
"""


def test_sensor_acts_only_while_its_tool_is_in_use(tmp_path):
    text = shipped_text("dual-extruder") + TWO_TOOLS
    with Scenario(load_text(text), card=str(tmp_path)) as s:
        s.passes(1)
        moves = [f"G1 X{50 + 20 * (i % 2)} Y50 E0.5 F1500" for i in range(10)]
        lines = ["M302 P1", "G28", "T0", "M83", *moves, "T1", *moves]
        (tmp_path / "a.g").write_text("\n".join(lines))
        s.host.ok("M32 a.g")
        s.host.expect("^wait", 1)
        assert s.until(lambda: s.board.net_steps("e") > 100, 100)
        s.board.force_input("filament-right", False)
        assert s.until(lambda: s.printer.rig.job.tool == 1, 100)
        s.host.expect("sensor right.*ended", 60)
        s.passes(5)
        assert s.board.net_steps("e") == pytest.approx(5 * 95.5, abs=300)  # some is retracted
        assert s.board.net_steps("e1") < 100
        s.board.force_input("filament-right", True)
        s.board.force_input("filament-left", False)
        s.host.ok("M24")
        s.host.expect("^Done printing file$", 200)
        assert s.board.net_steps("e1") == pytest.approx(5 * 95.5, abs=2)
        assert not [line for line in s.host.heard if "sensor left: the" in line]


@pytest.mark.parametrize("firmware", ["virtual", "passo"])
def test_sensor_on_a_further_board_pauses_the_print(tmp_path, firmware):
    sensors = {"roll": FilamentSensor(pin="^tool:D32")}
    machine = two_boards(firmware=firmware).model_copy(update={"filament_sensors": sensors})
    with Scenario(machine, card=str(tmp_path)) as s:
        printing(s, tmp_path, *turns(20))
        s.passes(4)
        s.board.force_input(INPUT, False)
        s.host.expect(ENDED, 1)
        s.passes(5)
        assert s.assembly.services.jobs.runner.state is JobState.PAUSED
        s.board.force_input(INPUT, True)
        s.host.ok("M24")
        s.host.expect("^Done printing file$", 200)
        assert s.positions()["e"] == pytest.approx(2.0, abs=0.01)


def test_switch_is_read_again_after_a_lost_link(tmp_path):
    machine = with_sensor()
    board = machine.board.model_copy(update={"firmware": "passo"})
    machine = machine.model_copy(update={"board": board})
    with Scenario(machine, card=str(tmp_path)) as s:
        printing(s, tmp_path, *turns(60))
        s.passes(5)
        break_link(s, 3)
        s.passes(5)
        assert s.printer.status.read().filament_sensors["roll"].detected is True
        s.board.force_input(INPUT, False)
        break_link(s, 3)
        s.host.expect(ENDED, 10)
        s.board.force_input(INPUT, True)
        s.passes(10)
        s.host.ok("M24")
        s.host.expect("^Done printing file$", 400)
        assert s.positions()["e"] == pytest.approx(6.0, abs=0.01)
