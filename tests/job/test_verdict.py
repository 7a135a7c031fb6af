"""Whether a file can be printed, and what would let it be printed."""

from __future__ import annotations

import io

import pytest
from tests.support.macro_machine import macro, with_macros

from passo import config
from passo.job.batch.verdict import fitting, shipped_printers, verdict
from passo.printer.unfit_commands import NOTHING, Skips


def judged(text: str, machine: str = "i3", skips: Skips = NOTHING):
    data = text.encode()
    return verdict(config.load(machine), io.BytesIO(data), len(data), "a.gcode", skips)


@pytest.mark.parametrize(
    ("line", "code", "allow"),
    [
        ("PRINT_START BED=60", "input.no-macro", ("unknown",)),
        ("G84 X1 Z1 R1", "input.unknown-moves", ("unknown",)),
        ("G29", "input.no-levelling", ("levelling",)),
        ("G1 X999", "input.out-of-range", ("clamp",)),
        ("T7", "input.missing-tool", ("ignore_tools",)),
    ],
)
def test_each_choice_lets_its_line_be_printed(line, code, allow):
    found = judged(f"G28\nG1 X10 F3000\n{line}\nG1 X20\n")
    assert [(problem.code, problem.line) for problem in found.problems] == [(code, 3)]
    assert found.allow == allow
    assert found.estimate is not None
    assert found.estimate.moves >= 2
    allowed = judged(f"G28\nG1 X10 F3000\n{line}\nG1 X20\n", skips=NOTHING.allowing(allow))
    assert (allowed.problems, allowed.allow) == ((), ())
    assert allowed.estimate == found.estimate


def test_all_choices_of_a_file_are_found_together():
    found = judged("G28\nT1\nG1 X999 F3000\nG29\nSTART_PRINT\nG1 X998\n")
    assert [p.line for p in found.problems] == [2, 3, 4, 5]
    assert found.allow == ("levelling", "unknown", "ignore_tools", "clamp")
    assert found.estimate is not None
    assert any("moved to the limit (2 times)" in text for text in found.estimate.warnings)


def test_one_error_without_a_choice_forbids_the_print():
    found = judged("G28\nG1 X999 F3000\nG1 X1..2\n")
    assert [p.code for p in found.problems] == ["input.out-of-range", "input.decimal-points"]
    assert (found.allow, found.estimate) == ((), None)


def test_a_levelling_machine_and_a_sound_file_need_no_choice():
    found = judged("G28\nG29\nG1 X10 F3000\n", "i3-probe")
    assert (found.problems, found.allow) == ((), ())


def test_macros_read_the_saved_variables_of_the_printer():
    gcode = "G28\nG1 X{printer.save_variables.variables.x}"
    data, machine = b"GO\n", with_macros(macro("GO", gcode))
    found = verdict(machine, io.BytesIO(data), len(data), "a.gcode", NOTHING, saved={"x": 99})
    assert (found.problems, found.allow) == ((), ())
    found = verdict(machine, io.BytesIO(data), len(data), "a.gcode", NOTHING)
    assert [(problem.code, problem.line) for problem in found.problems] == [("macro.template", 1)]


def test_the_first_machines_that_fit_are_named():
    data = b"G28\nPRINT_START\nG1 X190 Y190 Z205 F6000\n"
    names = fitting(shipped_printers(), io.BytesIO(data), len(data), "a.gcode", 3)
    assert len(names) == 3
    for name in names:
        machine = config.load(name)
        assert machine.heaters
        assert min(machine.size_mm) >= 190
    data = b"T3\nG28\nG1 X190 F6000\n"
    assert fitting(shipped_printers(), io.BytesIO(data), len(data), "a.gcode", 3) == [
        "multi-material"
    ]
