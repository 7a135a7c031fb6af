"""What is written for other machines and hosts: unknown commands, and the program goes on."""

from __future__ import annotations

import pytest

from passo._core import Fault

from .driver import run


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("O1000", "O1000"),
        ("o1000 (gear)", "O1000"),
        ("O1000 GEAR PROGRAM 1", "O1000"),
        ("O<probe> sub", "O<probe>"),
        ("N10 D5", "D5"),
        ("D 5", "D5"),
        ("H1", "H1"),
        ("Q5", "Q5"),
        ("Q5 #3", "Q5"),
        ("T?", "T?"),
        ("(which) T? ; tool", "T?"),
        ("Tx", "TX"),
        ("Tc", "TC"),
        ("T-1", "T-1"),
        ("/G1 X5", "/"),
        ("N20 /G1 X5", "/"),
        ("$H", "$H"),
        ("$J=G91 X10", "$J=G91"),
        ("@pause", "@PAUSE"),
        ("(host) @pause 5", "@PAUSE"),
        ("Q" + "0" * 5000, "Q" + "0" * 99),
        ("@" + "X" * 5000, "@" + "X" * 99),
    ],
)
def test_an_unknown_line_is_one_event(line, name):
    out = run(f"%\n{line}\nG1 X2\n")
    assert out.errors == []
    ((number, _, _, _, code, _),) = out.events
    assert (number, code.upper()) == (2, name.upper())
    assert out.ends == [(2, 0, 0, 0)]


def test_a_command_behind_a_program_number_counts():
    out = run("O1000 G91 G1 X5\nX5\n")
    assert out.commands == ["O1000"]
    assert out.ends == [(5, 0, 0, 0), (10, 0, 0, 0)]


def test_no_tool_leaves_the_tool():
    out = run("T0\nG1 E1\nT-1\nG1 X5 E2\n")
    assert out.commands == ["T0", "T-1"]
    assert out.ends == [(0, 0, 0, 1), (5, 0, 0, 2)]


@pytest.mark.parametrize("line", ["T", "S", "T0.5", "T.5", "T ?"])
def test_a_command_without_its_number_is_an_error(line):
    out = run(f"G1 X1\n{line}\n")
    assert [e[:2] for e in out.errors] == [(2, Fault.WORD)]
    assert out.events == []


def test_what_is_text_is_named_and_not_called_binary():
    assert run("G1 X1\n#1=5 G1\n").errors == [(2, Fault.WORD, "#1=5 G1", 0, 0)]


BOM = b"\xef\xbb\xbf"


@pytest.mark.parametrize("chunk", [0, 1, 2, 3, 4])
def test_a_byte_order_mark_in_front_means_nothing(chunk):
    out = run(BOM + b"G1 X1\nG1 X2\n", chunk=chunk)
    assert (out.errors, out.events) == ([], [])
    assert out.ends == [(1, 0, 0, 0), (2, 0, 0, 0)]
    assert run(BOM).errors == []


def test_a_byte_order_mark_elsewhere_is_garbage():
    for text, line in ((b"G1 X1\n" + BOM + b"G1 X2\n", 2), (BOM + BOM + b"G1 X1\n", 1)):
        assert [e[:2] for e in run(text).errors] == [(line, Fault.GARBAGE)]


@pytest.mark.parametrize("chunk", [0, 1, 2, 5, 7])
@pytest.mark.parametrize("end", ["\r", "\r\n", "\n"])
def test_each_line_end_counts_once(end, chunk):
    lines = ["; first", "G1 X1", "", "G1 X2 ; two", "M999", "G1 X3"]
    for last in ("", end):
        out = run(end.join(lines) + last, chunk=chunk)
        assert out.errors == []
        assert [m.line for m in out.moves] == [2, 4, 6]
        assert [e[0] for e in out.events] == [5]
        assert out.statistics["lines"] == 6


def test_line_ends_may_be_mixed():
    out = run("G1 X1\rG1 X2\nG1 X3\r\nG1 X4\r\rG1 X5\n\rG1 X6")
    ends = [(m.line, m.end_mm[0]) for m in out.moves]
    assert ends == [(1, 1), (2, 2), (3, 3), (4, 4), (6, 5), (8, 6)]


@pytest.mark.parametrize("chunk", [0, 50_000])
def test_a_comment_of_1_mb_before_a_cr(chunk):
    out = run(b"G1 X1\rG1 X2 ;" + b"x" * 1_000_000 + b"\rG1 X3\r", chunk=chunk)
    assert out.errors == []
    assert [(m.line, m.end_mm[0]) for m in out.moves] == [(1, 1), (2, 2), (3, 3)]


def test_many_lines_that_end_with_cr_in_one_piece():
    assert run(b"G4 P0\r" * 300_000).statistics["lines"] == 300_000
