"""Buttons, doors and stop switches: their actions and their G-code."""

from __future__ import annotations

import pytest
from tests.support.filament_printer import printing, turns, with_inputs
from tests.support.scenario import Host, Scenario

from passo.job.live.job_state import JobState

DOOR = '[buttons.door]\npin = "!^D36"\naction = "{}"\n'


def test_open_door_pauses_the_print(tmp_path):
    with Scenario(with_inputs(DOOR.format("pause")), card=str(tmp_path)) as s:
        printing(s, tmp_path, *turns(20))
        s.passes(4)
        s.host.ok("SIMULATE_FAULT NAME=button-door VALUE=pressed")
        s.host.expect("prompt_begin Button door has paused the print.*M24", 1)
        assert s.assembly.services.jobs.runner.state is JobState.PAUSED
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
        assert s.assembly.services.jobs.runner.state is state


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


def test_m226_waits_for_a_button_until_m108():
    keys = '[buttons.{}]\npin = "{}"\n'
    machine = with_inputs(keys.format("one", "D36") + keys.format("two", "D40"))
    with Scenario(machine) as s:
        s.passes(1)
        s.host.send("M226 P1", "M118 pressed", "M226 P1 S0", "M118 released", "M226 P0 S-1")
        s.host.silent(5, "pressed")
        s.board.force_input("button-two", True)
        s.host.expect("^pressed$", 1)
        s.host.silent(5, "released")
        s.board.force_input("button-two", False)
        s.host.expect("^released$", 1)
        s.host.silent(5, "^ok")
        Host(s).send("M108")
        s.passes(1)
        assert s.host.heard.count("ok") == 5
        assert "P" in s.host.ok("M226 P2")[0]


def test_m43_reports_inputs_and_watches_them():
    with Scenario(with_inputs(DOOR.format("none"))) as s:
        s.passes(1)
        assert s.host.ok("M43")[0] == "echo:button-door on pin !^D36: not active"
        s.host.ok("M43 W1")
        s.board.force_input("button-door", True)
        s.host.expect("^echo:button-door on pin !\\^D36: active$", 1)
        s.host.ok("M43 W0")
        s.board.force_input("button-door", False)
        s.host.silent(1, "button-door")


ANALOG = """[buttons.{}]
pin = "A11"
resistance_ohm = [{}, {}]
press_gcode = "M118 {}"
"""


def test_buttons_share_an_analog_input():
    machine = with_inputs(ANALOG.format("up", 0, 100, "up") + ANALOG.format("ok", 400, 600, "ok"))
    with Scenario(machine) as s:
        s.passes(1)
        assert s.printer.status.read().buttons == {"up": False, "ok": False}
        s.host.ok("SIMULATE_FAULT NAME=button-ok VALUE=pressed")
        s.host.expect("^ok$", 1)
        assert s.printer.status.read().inputs["button-ok"].active is True
        s.board.force_input("button-up", True)  # the other one is released by that
        s.host.expect("^up$", 1)
        assert s.printer.status.read().buttons == {"up": True, "ok": False}
        assert s.host.ok("M43")[:2] == [
            "echo:button-up on pin A11: active",
            "echo:button-ok on pin A11: not active",
        ]
        s.board.force_reading("analog-A11", 200 / 4900)  # between the ranges
        s.passes(1)
        assert s.printer.status.read().buttons == {"up": False, "ok": False}


@pytest.mark.parametrize("firmware", ["passo", "klipper"])
def test_analog_buttons_work_with_both_kinds_of_firmware(firmware: str):
    machine = with_inputs(ANALOG.format("up", 0, 100, "up"))
    board = machine.board.model_copy(update={"firmware": firmware})
    with Scenario(machine.model_copy(update={"board": board})) as s:
        s.passes(1)
        s.board.force_input("button-up", True)
        s.host.expect("^up$", 1)
        s.host.ok("M112")
        s.passes(1)
        s.host.send("M999")
        s.host.expect("ready again", 30)
        s.passes(1)
        assert s.printer.status.read().buttons == {"up": True}
        s.board.force_input("button-up", False)
        s.passes(1)
        assert s.printer.status.read().buttons == {"up": False}
