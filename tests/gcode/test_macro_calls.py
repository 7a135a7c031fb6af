"""Calls of macros: what a job hands out, and the order of what is inserted."""

from __future__ import annotations

import pytest
from tests.gcode.driver import spec

from passo import _core
from passo._core import JobStatus

NAMES = ["FOO", "_BAR", "G28", "T0", "M600", "M117"]
BUILT_IN = {"G28.1": "G28", "T0.1": "T0", "M117.1": "M117"}


def read(text, macros, *, console=False, listen=0):
    """(commands, calls, moves) of a text: codes of events, (line, code, text) of calls, and the
    line and X of moves. `macros` are the texts that calls become."""
    job = _core.Job(
        spec("i3") | {"macros": {"names": NAMES, "built_in": BUILT_IN}}, False, True, True
    )
    job.results.keep_moves(True)
    job.program.watch_line(listen)
    job.program.select(console)
    job.feed(text.encode())
    job.finish()
    commands, calls, errors = [], [], []
    while (found := job.advance()) not in (JobStatus.END, JobStatus.NEED_INPUT):
        line, letter, number, minor, name, rest = job.event
        code = name or f"{letter}{number}" + (f".{minor}" if minor else "")
        if found == JobStatus.MACRO:
            calls.append((line, code, rest))
            job.program.insert(macros.get(code, "").encode(), code)
        elif found == JobStatus.EVENT:
            commands.append(code)
        elif found == JobStatus.ERROR:
            errors.append(job.error[:3])
    job.flush()
    moves = [(move.line, round(move.end_mm[0], 6)) for move in job.results.take_moves()]
    return commands, calls, moves, errors, job


def test_inserted_lines_have_the_line_of_the_call():
    macros = {"FOO": "G1 X1\nG1 X2\nM400"}
    commands, calls, moves, _, _ = read("G1 X9 F600\n\nfoo A=1 b=2 ; note\nG1 X3\n", macros)
    assert calls == [(3, "FOO", "A=1 b=2")]
    assert moves == [(1, 9), (3, 1), (3, 2), (4, 3)]
    assert commands == ["M400"]


@pytest.mark.parametrize("console", [False, True])
def test_the_rest_of_a_line_comes_after_its_macro(console):
    macros = {"G28": "G1 X1 F600", "T0": "G1 X2 F600"}
    _, calls, moves, _, _ = read("G28 Y G1 X5 T0 P3 M84\nG1 X7\n", macros, console=console)
    assert [call[1:] for call in calls] == [("G28", "Y"), ("T0", "P3")]
    assert [x for _, x in moves] == [1, 5, 2, 7]


def test_within_a_macro_its_name_is_the_built_in_command():
    """At any depth, until the macro ends. A macro without a command of its name calls itself."""
    macros = {"G28": "FOO\nG28 Z", "FOO": "_bar\nG28 Y M600", "_BAR": "G28 X\nM400", "M600": ""}
    within = ["G28", "M400", "G28", "G28"]
    commands, calls, _, _, _ = read("G28\n", macros)
    assert commands == within
    assert [call[1:] for call in calls] == [("G28", ""), ("FOO", ""), ("_BAR", ""), ("M600", "")]
    commands, calls, _, _, _ = read("_BAR\nG28.1\n", macros)
    assert commands == [*within, "M400", "G28"]
    assert [code for _, code, _ in calls] == ["_BAR", "G28", "FOO", "_BAR", "M600"]


def test_macros_call_macros_and_built_in_commands():
    macros = {"FOO": "G28\nG1 X3 F600\n_bar", "G28": "G28.1 X\nM117.1 G28 done", "_BAR": "G1 X4"}
    commands, calls, moves, _, _ = read("FOO\nG1 X5\nM117.1 FOO\n", macros)
    assert [code for _, code, _ in calls] == ["FOO", "G28", "_BAR"]
    assert commands == ["G28", "M117", "M117"]
    assert moves == [(1, 3), (1, 4), (2, 5)]


def test_m99_leaves_a_macro():
    _, _, moves, _, _ = read("FOO\nG1 X5\n", {"FOO": "G1 X1 F600\nM99\nG1 X2"})
    assert moves == [(1, 1), (2, 5)]


def test_an_error_in_a_macro_has_the_line_of_the_call():
    _, _, moves, errors, _ = read("\nFOO\nG1 X5 F600\n", {"FOO": "G1 X1 F0\nG1 X2 F600"})
    assert errors == [(2, _core.Fault.FEEDRATE, "F")]
    assert moves == [(2, 2), (3, 5)]


def test_call_in_comment_or_text_is_ignored():
    _, calls, _, _, _ = read(
        "; FOO\nM118 FOO\n(FOO)\nEXCLUDE_OBJECT_START NAME=FOO\nM104 S1 T0\n", {}
    )
    assert calls == []


def test_a_file_that_ends_in_a_macro_is_not_cut_short():
    assert not read("FOO", {"FOO": "G1 X1 F600"})[-1].program.ends_in_move
    assert read("FOO\nG1 X2", {"FOO": "G1 X1 F600"})[-1].program.ends_in_move


def test_macros_are_not_called_where_all_is_plain():
    job = _core.Job(
        spec("i3") | {"macros": {"names": NAMES, "built_in": BUILT_IN}}, False, True, True
    )
    job.options.plain = True
    job.feed(b"T0\nFOO\n")
    assert job.advance() == JobStatus.EVENT
    assert job.advance() == JobStatus.EVENT
    assert job.event[4] == "FOO"


def test_only_the_call_of_a_line_is_recorded():
    job = read("FOO A=1\n", {"FOO": "G1 X1 F600\nM400"}, listen=1)[-1]
    assert job.program.watched_line[2] == [("FOO", [], "A=1")]


def test_a_console_is_at_a_boundary_when_its_macros_are_over():
    job = _core.Job(
        spec("i3") | {"macros": {"names": NAMES, "built_in": BUILT_IN}}, False, True, True
    )
    job.program.select(True)
    job.feed(b"FOO\n")
    assert job.advance() == JobStatus.MACRO
    job.program.insert(b"M400\nM400")
    assert job.advance() == JobStatus.EVENT
    assert (job.program.at_boundary, job.program.macro_depth) == (False, 1)
    job.program.forget_macros()
    assert (job.program.at_boundary, job.program.macro_depth) == (True, 0)
    assert job.advance() == JobStatus.NEED_INPUT
