"""Declared parameters: what consoles, prints and rehearsals accept, and what they refuse."""

import io

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.errors import CommandError, WordError
from passo.gcode.command import Command
from passo.gcode.parameters import Form, shown
from passo.gcode.registry import Subject, row_of, table
from passo.job.batch.verdict import verdict
from passo.printer.unfit_commands import NOTHING

I3 = config.load("i3")
WRONG = {
    "M149 K": "M149 is K: expected C",
    "M206 X999": "X is 999: expected at most the",
    "M303 S200 R9": "R is 9: expected 0 to 5",
    "M303 H7 S200": "hotend",
    "M303 S-5": "S is -5: expected more than 5 C",
    "M306 A300": "A is 300: expected 0 to 255",
    "M307 H0 A200": "is not controlled by its model",
    "M569 S2 X": "S is 2: expected 0 or 1",
    "M569 X1": "steppers is fixed",
    "M852 I5": "I is 5: expected -",
    "FORCE_MOVE STEPPER=stepper_x DISTANCE=5": "FORCE_MOVE needs VELOCITY=",
    "FORCE_MOVE STEPPER=stepper_q DISTANCE=5 VELOCITY=5": "STEPPER is stepper_q: expected",
    "FORCE_MOVE STEPPER=stepper_x DISTANCE=9999 VELOCITY=5": "DISTANCE is 9999: expected",
    "SET_SKEW XY=1,2": "XY is 1,2: expected the lengths",
    "STEPPER_BUZZ STEPPER=fan": "STEPPER is fan: expected stepper_x",
    "SET_PRINT_STATS_INFO TOTAL_LAYER=1.5": "TOTAL_LAYER is 1.5: expected 0 to 1,000,000",
    "SET_PRESSURE_ADVANCE ADVANCE=20": "ADVANCE is 20: expected 0 to 10 s",
    "SET_INPUT_SHAPER SHAPER_FREQ_X=fast": "the word 'SHAPER_FREQ_X=fast' has no valid number",
    "M593 F5": "F is 5: expected 0 (off), or 15 to 500 Hz",
    "M85 S-1": "S is -1: expected at least 0 s",
}


@pytest.mark.parametrize("line", WRONG)
def test_rehearsal_finds_a_wrong_parameter(line):
    data = f"G28\n{line}\n".encode()
    found = verdict(I3, io.BytesIO(data), len(data), "a.gcode", NOTHING)
    (problem,) = found.problems
    assert (problem.line, found.estimate) == (2, None)
    assert WRONG[line] in problem.sentence


def test_console_refuses_what_a_rehearsal_finds():
    with Scenario("i3") as s:
        for line in (line for line in WRONG if not line.startswith("M852")):
            assert any(WRONG[line] in answer for answer in s.host.ok(line)), line


def test_letters_that_are_not_declared_are_noted_in_a_rehearsal_only():
    data = b"G28\nM106 S20 W5\nSET_FAN_SPEED FAN=fan SPEED=1 LOUD=1\n"
    found = verdict(I3, io.BytesIO(data), len(data), "a.gcode", NOTHING)
    assert [text for text in found.estimate.warnings if "has no effect" in text] == [
        "a.gcode:2: W of M106 has no effect (1 time)",
        "a.gcode:3: LOUD of SET_FAN_SPEED has no effect (1 time)",
    ]
    with Scenario("i3") as s:
        assert s.host.ok("M106 S20 W5") == ["ok"]


def test_called_command_has_the_values_and_the_text_of_a_line():
    called = Command.call("M106", P=1, S=127.5, F=True, T=None)
    assert (called.code, called.text) == ("M106", "P1 S127.5 F")
    assert (called.words(), called.letters()) == ({"P": 1, "S": 127.5}, ["P", "S", "F"])
    assert (called.value("S"), called.flag("F"), called.has("T")) == (127.5, True, False)
    named = Command.call("SET_FAN_SPEED", FAN='a "b"', SPEED=0.5)
    assert Command(0, "", 0, 0, "SET_FAN_SPEED", named.text).pairs() == {
        "FAN": 'a "b"',
        "SPEED": "0.5",
    }
    with pytest.raises(CommandError, match="ADVANCE is 20: expected 0 to 10 s"):
        Command.call("SET_PRESSURE_ADVANCE", ADVANCE=20).check()


def test_value_is_that_of_the_line_or_the_declared_one():
    assert Command(0, "M", 48, 0, "", "P7").value("P") == 7
    assert Command(0, "M", 48, 0, "", "").value("P") == 10
    assert Command(0, "M", 48, 0, "", "").value("X", None) is None
    with pytest.raises(CommandError, match="M48 needs X"):
        Command(0, "M", 48, 0, "", "").value("X")


def test_text_in_place_of_a_number_is_refused():
    with pytest.raises(WordError, match="'S' has no valid number"):
        Command(0, "M", 104, 0, "", 'S"hot"').check()


def test_every_declared_parameter_has_a_text():
    for row in table().values():
        for parameter in shown(row.parameters):
            assert parameter.text or parameter.form is Form.ANYTHING, row.code
        names = [name for parameter in row.parameters for name in parameter.names]
        assert len(names) == len(set(names)), row.code
        if row.subject is not Subject.NO_EFFECT and not row.code[1:2].isdigit():
            assert row.takes_text or all(len(n) > 1 or n.isalpha() for n in names), row.code


def test_help_shows_a_command_with_its_parameters():
    assert row_of("M572").help.endswith("Parameters: D(at least 0, default 0) S(0 to 10 s)")
    with Scenario("i3") as s:
        assert s.host.ok("HELP m572")[1:3] == [
            "echo:  D(at least 0, default 0): the extruder",
            "echo:  S(0 to 10 s): the advance",
        ]
        assert "HELP is M5: expected" not in s.host.ok("HELP M5")[0]
        assert "HELP is NONE: expected a command" in s.host.ok("HELP none")[0]
