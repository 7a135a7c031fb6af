"""Buttons, doors and stop switches: their actions and their G-code."""

from __future__ import annotations

import pytest
from tests.support.filament_printer import printing, turns, with_inputs
from tests.support.scenario import Scenario

from passo.job.live.job_state import JobState

DOOR = '[buttons.door]\npin = "!^D36"\naction = "{}"\n'


def test_open_door_pauses_the_print(tmp_path):
    with Scenario(with_inputs(DOOR.format("pause")), card=str(tmp_path)) as s:
        printing(s, tmp_path, *turns(20))
        s.passes(4)
        s.host.ok("SIMULATE_FAULT NAME=button-door VALUE=pressed")
        s.host.expect("prompt_begin Button door has paused the print.*M24", 1)
        assert s.assembly.runner.state is JobState.PAUSED
        assert s.printer.status.read().buttons == {"door": True}
        s.host.ok("SIMULATE_FAULT NAME=button-door VALUE=none")
        s.host.ok("M24")
        s.host.expect("^Done printing file$", 100)
        assert s.positions()["e"] == pytest.approx(2.0, abs=0.01)


@pytest.mark.parametrize(
    ("action", "state"), [("cancel", JobState.READY), ("none", JobState.PRINTING)]
)
def test_button_acts_on_the_print(tmp_path, action, state):
    with Scenario(with_inputs(DOOR.format(action)), card=str(tmp_path)) as s:
        printing(s, tmp_path, *turns(20))
        s.passes(4)
        s.board.force_input("button-door", True)
        s.passes(1)
        assert s.assembly.runner.state is state


def test_button_resumes_a_paused_print(tmp_path):
    with Scenario(with_inputs(DOOR.format("resume")), card=str(tmp_path)) as s:
        printing(s, tmp_path, *turns(20))
        s.passes(4)
        s.host.ok("M25")
        s.passes(5)
        s.board.force_input("button-door", True)
        s.host.expect("^Done printing file$", 100)


def test_stop_switch_halts_with_heaters_off_until_m999():
    with Scenario(with_inputs(DOOR.format("halt"))) as s:
        s.host.ok("M104 S200")
        s.passes(5)
        s.board.force_input("button-door", True)
        s.passes(1)
        status = s.printer.status.read()
        assert status.halted == "the stop button door was pressed"
        assert [fault.code for fault in status.faults] == ["machine.stop-button"]
        assert s.printer.rig.connection.heaters["hotend"].power == 0


def test_press_and_release_run_gcode_in_their_order():
    keys = 'press_gcode = "M118 {printer[\'gcode_button lamp\'].state}"\nrelease_gcode = "M118 off"'
    with Scenario(with_inputs(f'[buttons.lamp]\npin = "D36"\n{keys}\n')) as s:
        s.host.silent(2, "RELEASED|off")  # its first level is not an event
        s.board.force_input("button-lamp", True)
        s.host.expect("^PRESSED$", 1)
        s.board.force_input("button-lamp", False)
        s.host.expect("^off$", 1)


def test_debounce_ignores_short_presses():
    machine = with_inputs(
        '[buttons.lamp]\npin = "D36"\npress_gcode = "M118 on"\ndebounce_s = 0.5\n'
    )
    with Scenario(machine) as s:
        s.passes(1)
        s.board.force_input("button-lamp", True)
        s.passes(0.3)
        s.board.force_input("button-lamp", False)
        s.host.silent(2, "^on$")
        s.board.force_input("button-lamp", True)
        s.host.expect("^on$", 1)
