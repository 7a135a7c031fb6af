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


def test_a_command_after_a_program_number_counts():
    out = run("O1000 G91 G1 X5\nX5\n")
    assert out.commands == ["O1000"]
    assert out.ends == [(5, 0, 0, 0), (10, 0, 0, 0)]


def test_no_tool_leaves_the_tool():
    out = run("T0\nG1 E1\nT-1\nG1 X5 E2\n")
    assert out.commands == ["T0", "T-1"]
    assert out.ends == [(0, 0, 0, 1), (5, 0, 0, 2)]


@pytest.mark.parametrize("line", ["T", "S", "T0.5", "T.5"])
def test_a_command_without_its_number_is_an_error(line):
    out = run(f"G1 X1\n{line}\n")
    assert [e[:2] for e in out.errors] == [(2, Fault.WORD)]
    assert out.events == []


def test_text_file_is_not_reported_as_binary():
    assert run("G1 X1\n!5 G1\n").errors == [(2, Fault.WORD, "!5 G1", 0, 0)]


@pytest.mark.parametrize(
    ("line", "word", "character"),
    [
        ("G1 E31,0000 F1980", "E31,0000", ","),
        ("G1 E-31,5", "E-31,5", ","),
        ("G92 E1,5", "E1,5", ","),
        ("G4 P1,5", "P1,5", ","),
        ("T ?", "?", "?"),
        ("G28 X1,5", "X1,5", ","),
        ("G2 X5,5 I1", "X5,5", ","),
        ("X5,5", "X5,5", ","),
        ("G1 X10, Y20", "X10,", ","),
        ("M207 S1,5", "S1,5", ","),
        ("G1 X1.2.3", "X1.2.3", "."),
        ("G4 P1.2.3", "P1.2.3", "."),
        ("G4 P1..2", "P1..2", "."),
        ("#1=5", "#1=5", "#"),
        ("G1 X#3", "X#3", "#"),
        ("G1 X-#<depth>", "X-#<depth>", "#"),
        ("G0 X[#1+1] Y5", "X[#1+1]", "["),
        ("G1 X{start_x} Y5", "X{start_x}", "{"),
        ("{if layer} G1 X5", "{if", "{"),
        ("G1 X=5", "X=5", "="),
        ("G1 X\N{MINUS SIGN}5", "X\N{MINUS SIGN}5", "\N{MINUS SIGN}"),
        ("G1 X5 \N{EM DASH} there", "\N{EM DASH}", "\N{EM DASH}"),
        ("G28 \N{EN DASH} home", "\N{EN DASH}", "\N{EN DASH}"),
        ("G1 X“5”", "X“5”", "“"),
        ("\xa0G1 X5", "\xa0G1", "\xa0"),
        ("G1\xa0X5", "G1\xa0X5", "\xa0"),
        ("G1 X5\u200b", "X5\u200b", "\u200b"),
        ("\ufeffG1 X5", "\ufeffG1", "\ufeff"),
        ("G1 \uff385", "\uff385", "\uff38"),
        ("G1 \u04255", "\u04255", "\u0425"),  # of Cyrillic
        ("N5 G1 X5 (why) Y5,5", "Y5,5", ","),
        ("G1 X5 Y0." + "5" * 40 + ",5", "5" * 20 + ",5", ","),
    ],
)
def test_a_character_that_is_not_g_code_is_named(line, word, character):
    out = run(f"G1 X1\n{line}\nG1 X2\n".encode())
    assert out.errors[0] == (2, Fault.STRAY, word, ord(character), 0)
    assert [end[0] for end in out.ends[:1]] == [1]


def test_a_byte_that_is_not_utf_8_is_named():
    for line in (b"G1 X\x965", b"\x96G1 X5", b"G1 X5\xe2\x80", b"G28\xa0"):
        ((_, fault, word, value, _),) = run(b"G1 X1\n" + line + b"\n").errors
        assert (fault, value < 0, "\N{REPLACEMENT CHARACTER}" in word) == (Fault.STRAY, True, True)


@pytest.mark.parametrize(
    "line", ["M84 готово", "M117 31,5 — “hi”", "G29 P1,5", "M204 S500, T500", "M106 S255 // on"]
)
def test_remark_without_semicolon_is_not_read_as_words(line):
    assert run(f"{line}\nG1 X2\n".encode()).errors == []


@pytest.mark.parametrize("chunk", [0, 1, 7])
@pytest.mark.parametrize(
    "end",
    [
        b"\0" * 512,
        b"\0" * 200_000,
        b"\n\0\0\n\0",
        b"\n" + b"\0" * 512,
        b"\n\x1a",
        b"\x1a",
        b"\r\n\x1a\r\n",
        b"\n\x1a\x1a\x1a\0\0",
        b"\n\x1arubbish\xff\0\x01\nof the block\n\x80\0" + b"\x02" * 300,
        b" ; done\0\0",
        b"\n\x1a" + bytes(range(128, 256)) * 600,
    ],
)
def test_end_of_cut_or_dos_file_is_not_a_line(end, chunk):
    out = run(b"G1 X1\r\nG1 X2" + end, chunk=chunk)
    assert (out.errors, out.events) == ([], [])
    assert [e[0] for e in out.ends] == [1, 2]


@pytest.mark.parametrize(
    ("text", "errors"),
    [
        (b"G1 X1\n\0\0\0\nG1 X2\n", [(3, Fault.HOLE, 2)]),
        (b"G1 X1\0\0\n; a comment\nG1 X2\n", [(2, Fault.HOLE, 1), (3, Fault.HOLE, 1)]),
        (b"G1 X1\n\x1a\nG1 X2\n", [(3, Fault.AFTER_END, 2)]),
        (b"G1 X1\n\x1ajunk\nmore junk\n N5 G1 X2\n", [(4, Fault.AFTER_END, 2)]),
        (b"G1 X1\nG1\0 X2\n", [(2, Fault.GARBAGE, 0)]),
    ],
)
def test_bytes_after_end_of_text_are_reported(text, errors):
    out = run(text)
    assert [(e[0], e[1], e[3]) for e in out.errors] == errors
    assert [e[0] for e in out.ends] == [1]


@pytest.mark.parametrize("code", ["utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("text", ["G1 X1\n", "; a comment\n\nG1 X1\n", "\r\nG28\r\n"])
def test_utf_16_is_named(code, text):
    out = run(text.encode(code))
    assert out.errors[0][1] == Fault.UTF_16
    assert out.ends == []


BOM = b"\xef\xbb\xbf"


@pytest.mark.parametrize("chunk", [0, 1, 2, 3, 4])
def test_leading_byte_order_mark_is_ignored(chunk):
    out = run(BOM + b"G1 X1\nG1 X2\n", chunk=chunk)
    assert (out.errors, out.events) == ([], [])
    assert out.ends == [(1, 0, 0, 0), (2, 0, 0, 0)]
    assert run(BOM).errors == []


def test_a_byte_order_mark_elsewhere_is_named():
    for text, line in ((b"G1 X1\n" + BOM + b"G1 X2\n", 2), (BOM + BOM + b"G1 X1\n", 1)):
        assert [(*e[:2], e[3]) for e in run(text).errors] == [(line, Fault.STRAY, 0xFEFF)]


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
