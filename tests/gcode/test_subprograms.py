"""M98 and M99: sub-programs behind the end of a file's main program."""

from __future__ import annotations

import pytest
from tests.gcode.driver import run, spec

from passo._core import CallFault, Fault, Survey

MAIN = "O1 (MAIN)\nG0 X1\nM98 P1002 L3\nG0 X50\nM30\n"
DRILL = "O1002 (DRILL)\nG91\nG1 Z-1\nG1 X5\nG0 Z1\nG90\nM99\n"


def called(text, machine="unbounded", **words):
    return run(text, machine, surveyed=True, **words)


def places(out):
    return [(round(m.end_mm[0], 6), round(m.end_mm[2], 6)) for m in out.moves]


def test_a_subprogram_is_carried_out_as_often_as_asked():
    out = called(MAIN + DRILL)
    assert out.errors == []
    assert out.commands == ["M30"]
    assert places(out) == [
        (1, 0),
        (1, -1), (6, -1), (6, 0),
        (6, -1), (11, -1), (11, 0),
        (11, -1), (16, -1), (16, 0),
        (50, 0),
    ]  # fmt: skip
    assert [m.line for m in out.moves] == [2, 8, 9, 10, 8, 9, 10, 8, 9, 10, 4]


@pytest.mark.parametrize("chunk", [1, 5, 64])
def test_calls_do_not_depend_on_how_the_text_is_cut(chunk):
    assert called(MAIN + DRILL, chunk=chunk).ends == called(MAIN + DRILL).ends


FORMS = {
    "M98 P1002": 1,
    "m98p1002l2": 2,
    "M98 P1002 L0": 0,
    "M98 L2 P1002": 2,
    "M98 P21002": 2,
    "N40 M98 P1002 ; twice no": 1,
    "G90 M98 P1002": 1,
    "X1 M98 P1002": 1,
    "M98 P01002 (drill)": 1,
}


@pytest.mark.parametrize(("call", "times"), FORMS.items())
def test_m98_is_read_in_all_forms(call, times):
    out = called(MAIN.replace("M98 P1002 L3", call) + DRILL)
    assert out.errors == []
    assert len(out.moves) == 2 + 3 * times


ENDS = ["M30", "M2", "N90 M30", "M02", "m30", "M99"]


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize("label", ["O1002", "o01002", "O1002 G21", "N1002", "N1002 G1 Y1"])
def test_labels_and_ends_are_read_in_all_forms(end, label):
    out = called(MAIN.replace("M30", end) + DRILL.replace("O1002 (DRILL)", label))
    assert out.errors == []
    moves = [m for m in out.moves if m.end_mm[1] == m.start_mm[1]]
    assert len(moves) >= 11


def test_calls_within_calls_return_to_each_other():
    text = "M98 P1 L2\nG0 X0\nM30\nO1\nG91 G0 X1\nM98 P2 L2\nG0 Y1 G90\nM99\nO2\nG0 Z1\nM99\n"
    out = called(text)
    assert [m.line for m in out.moves] == [5, 10, 10, 7, 5, 10, 10, 7, 2]
    assert [round(v) for v in out.moves[-1].start_mm[:3]] == [2, 2, 4]


def test_a_return_within_a_line_of_moves_comes_after_them():
    out = called("M98 P1\nG0 X9\nM30\nO1\nG0 X1 M99\nG0 X5\n")
    assert [m.end_mm[0] for m in out.moves] == [1, 9]


def test_the_end_of_the_program_within_a_subprogram_ends_all():
    out = called("M98 P1\nG0 X9\nM30\nO1\nG0 X1\nM30\nM99\n")
    assert out.commands == ["M30"]
    assert [m.end_mm[0] for m in out.moves] == [1]


def test_a_cycle_within_a_subprogram():
    text = "F100\nG0 Z5\nG81 X1 Z-1 R1\nM98 P1\nG80\nM30\nO1\nX2\nX3\nM99\n"
    out = called(text)
    assert out.errors == []
    assert sorted({m.end_mm[0] for m in out.moves}) == [0, 1, 2, 3]
    assert sum(m.end_mm[2] == -1 for m in out.moves) == 3


BAD = {  # a main program and what is behind it, the fault, the line it is found in
    "missing": ("M98 P7\nM30\nO1\nM99\n", CallFault.MISSING, 1),
    "before the end": ("O7\nG0 X1\nM99\nM98 P7\nM30\n", None, None),
    "no number": ("M98\nM30\nO1\nM99\n", CallFault.UNREADABLE, 1),
    "a file of others": ('M98 P"0:/macros/a.g"\nM30\nO1\nM99\n', CallFault.UNREADABLE, 1),
    "a fraction": ("M98 P1.5\nM30\nO1\nM99\n", CallFault.UNREADABLE, 1),
    "too often": ("M98 P1 L10000\nM30\nO1\nM99\n", CallFault.UNREADABLE, 1),
    "other words": ("M98 P1 X5\nM30\nO1\nM99\n", CallFault.UNREADABLE, 1),
    "no return": ("M98 P1\nM30\nO1\nG0 X1\n", CallFault.UNENDED, 1),
    "no return before the next": ("M98 P1\nM30\nO1\nG0 X1\nO2\nM99\n", CallFault.UNENDED, 1),
    "in what is called": ("M98 P1\nM30\nO1\nM98 P3\nM99\nO2\nM98 P4\nM99\n", CallFault.MISSING, 4),
}


@pytest.mark.parametrize(("text", "fault", "line"), BAD.values(), ids=BAD)
def test_bad_calls_are_found_before_the_program_runs(text, fault, line):
    survey = Survey(spec("cnc"))
    survey.feed(text.encode())
    survey.finish()
    assert [(found[0], found[2]) for found in survey.bad_calls] == [(line, fault)] * bool(line)
    out = called(text)
    found = [(e[1], int(e[3])) for e in out.errors]
    assert found[:1] == ([(Fault.CALL, int(fault))] if fault else [])


def test_a_recursion_without_end_is_stopped():
    out = called("M98 P1\nG0 X9\nM30\nO1\nG91 G0 X1 G90\nM98 P1\nM99\n")
    assert [(e[1], int(e[3])) for e in out.errors] == [(Fault.CALL, int(CallFault.NESTED))]
    assert [m.end_mm[0] for m in out.moves] == [*range(1, 11), 9]


def test_calls_without_a_move_are_stopped():
    text = "M98 P1 L9999\nG0 X9\nM30\nO1\nM98 P2 L9999\nM99\nO2\n; nothing\nM99\n"
    out = called(text)
    assert [(e[1], int(e[3])) for e in out.errors] == [(Fault.CALL, int(CallFault.IDLE))]
    assert [m.end_mm[0] for m in out.moves] == [9]


def test_a_program_that_was_not_surveyed_calls_nothing():
    out = run(MAIN + DRILL, "unbounded")
    assert [(e[1], int(e[3])) for e in out.errors] == [(Fault.CALL, int(CallFault.NO_FILE))]


def test_uncalled_subprograms_do_not_count():
    survey = Survey(spec("cnc"))
    survey.feed(b"M98 P1\nM30\nPRINT_END\nO1\nM98 P2\nM99\nO2\nG84\nM99\nO3\nSTART_PRINT\nM99\n")
    survey.finish()
    codes = [name or f"{letter}{number}" for _, letter, number, _, name, _ in survey.commands]
    assert [code for code in codes if code[0] != "O"] == ["M30", "G84"]
    assert next(row[0] for row in survey.commands if row[2] == 84) == 8
