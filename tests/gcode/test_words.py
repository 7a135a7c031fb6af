"""Lines and words: every way that G-code is written, and what is no G-code."""

from __future__ import annotations

from functools import reduce
from math import isnan
from operator import xor

import pytest

from passo._core import Fault, Job, JobStatus, split_text, without_exponents
from passo.errors import WordError
from passo.gcode.command import Command
from passo.gcode.parameters import Form
from passo.gcode.registry import Kind, table

from .driver import run, spec


@pytest.mark.parametrize(
    "line",
    [
        "G1 X10 Y20 E1.5",
        "g1 x10 y20 e1.5",
        "G1X10Y20E1.5",
        "G01 X10.000 Y+20. E1.50",
        "G1 X 10 Y 20 E 1.5",
        "\tG1\tX10\tY20\tE1.5 \r",
        "G1 X10 Y20 E1.5;comment X99",
        "G1 X10 (X99) Y20 (a; b) E1.5",
        "(first) G1 X10 Y20 E1.5",
        "N12 G1 X10 Y20 E1.5",
        "N12G1X10Y20E1.5*86",
        "G1 E1.5 Y20 X10",
        "G1 X1E1 Y2.0e+01 E0.15E1",
        "G1 X1.0E+01 Y20 E1500e-3",
        "G1 Y.2e2 X10 E1.5e00",
        "X10 Y20 E1.5",
    ],
)
def test_spellings_of_a_move_are_equal(line):
    out = run(f"{line}\n")
    assert out.errors == []
    assert out.events == []
    assert out.ends == [(10, 20, 0, 1.5)]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\n\n", "\n%\n", "\n\r\n"])
def test_line_ends(end):
    assert run(end.join(["%", "G1 X1", "G1 X2", "G0 X3"])).ends == [
        (1, 0, 0, 0),
        (2, 0, 0, 0),
        (3, 0, 0, 0),
    ]


def checked(line):
    return f"{line}*{reduce(xor, line.encode())}"


def test_right_and_wrong_checksums():
    good = "N3 T0*57\n"
    assert run(good).errors == []
    ((line, fault, word, value, _),) = run("G4 P1\nN3 T0*58\n").errors
    assert (line, fault, word, value) == (2, Fault.CHECKSUM, "*58", 57)
    assert run("N3 T0*58\n").events == []


@pytest.mark.parametrize(
    "line", ["N10 (*** face ***)", "N10 ; 2*3", "N10 G1 X5 (3*4) Y6", "N10 G1 X5 Y6 ; 4*5"]
)
def test_a_star_in_a_comment_begins_no_checksum(line):
    out = run(f"{line}\nG1 X7\n")
    assert out.errors == []
    assert out.ends[:-1] == ([(5, 6, 0, 0)] if "Y6" in line else [])


@pytest.mark.parametrize(
    "text",
    ["M486 S0 Aspanner 13*10.stl", "M486 Apart 13*10", "M117 3*4", "EXCLUDE_OBJECT_START NAME=a*2"],
)
def test_a_star_in_a_text_of_a_numbered_line_is_not_a_checksum(text):
    command, _, rest = text.partition(" ")
    for line in (text, f"N5 {text}", checked(f"N5 {text}"), checked(f"N5 {text}") + " ; 1*2"):
        job = Job(spec("i3"), False)
        job.program.watch_line(1)
        job.feed(line.encode() + b"\n")
        job.finish()
        assert job.advance() in (JobStatus.EVENT, JobStatus.END)
        assert job.program.watched_line[2] == [(command, [], rest)]


def test_a_checksum_is_after_the_last_star():
    text = "N3 G1 X5 (3*4)"
    sum_ = reduce(xor, text.encode())
    assert run(f"{text}*{sum_}\n").errors == []
    assert [e[1] for e in run(f"{text}*{sum_ ^ 1}\n").errors] == [Fault.CHECKSUM]


def test_lines_without_a_command_repeat_the_last_motion():
    out = run("G0 X10\nY10\nG2 X20 I5\nX10 I-5\nG1 F600\nX0 Y0\n")
    assert out.errors == []
    assert out.statistics["arcs"] == 2
    assert out.ends[-1] == (0, 0, 0, 0)


@pytest.mark.parametrize(
    ("line", "end"),
    [
        ("G1 X1E5", (1, 0, 0, 5)),
        ("g1 x1e5", (1, 0, 0, 5)),
        ("G1X10E-3", (10, 0, 0, -3)),
        ("G1X1.5Y2E-1F600", (1.5, 2, 0, -1)),
        ("G1 E-.5", (0, 0, 0, -0.5)),
        ("G1 X.5Y5.", (0.5, 5, 0, 0)),
        ("G1 X1E1.5", (1, 0, 0, 1.5)),
        ("G1 X1E-0.5", (1, 0, 0, -0.5)),
        ("G1 X1 E-05", (1, 0, 0, -5)),
        ("G1E-2", (0, 0, 0, -2)),
    ],
)
def test_an_e_that_may_be_a_word_is_one(line, end):
    assert run(f"M83\n{line}\n").ends == [end]


@pytest.mark.parametrize(
    ("line", "end"),
    [
        ("G1 X12 E9.9e-05", (12, 0, 0, 9.9e-5)),
        ("G1 X12 E1.2E-04 F600", (12, 0, 0, 1.2e-4)),
        ("G1X12E9.9e-5", (12, 0, 0, 9.9e-5)),
        ("G1 E-1E-1 X12", (12, 0, 0, -0.1)),
        ("G1 X13.5e-3", (0.0135, 0, 0, 0)),
        ("G1 X13.5E-3 Y5", (0.0135, 5, 0, 0)),
        ("G1X13.5e-3Y5", (0.0135, 5, 0, 0)),
        ("G1X1.35E-02Y5", (0.0135, 5, 0, 0)),
        ("G0 X1e+01", (10, 0, 0, 0)),
        ("G1 X1E1 Y2E1 E3", (10, 20, 0, 3)),
        ("X1.25E+01 E2", (12.5, 0, 0, 2)),
        ("G1 X 1.25e-1 E2", (0.125, 0, 0, 2)),
        ("G1 X-1.25e-1 E123456.789e-6", (-0.125, 0, 0, 0.123456789)),
        ("G2 X10 I5.0 J1.2e-05", (10, 0, 0, 0)),
        ("G90 X1e-02 E1e-02", (0.01, 0, 0, 0.01)),
    ],
)
def test_an_e_that_is_not_a_word_is_an_exponent(line, end):
    out = run(f"M83\n{line}\n", "unbounded")
    assert out.errors == []
    assert out.ends[-1] == pytest.approx(end, abs=1e-12)


def test_an_exponent_where_e_is_not_a_word_of_the_command():
    out = run("G4 P1.5e3\nM204 P1E3\nM104 S2.1E2\nM92 X8E1\nM117 at 1e-05\nM23 a1e-05.gco\n")
    assert out.statistics["dwell_s"] == 1.5
    assert out.commands == [
        "M204 P1000",
        "M104 S210",
        "M92 X8E1",
        "M117 at 1e-05",
        "M23 a1e-05.gco",
    ]
    spindle = run("G1 X1E1 Y2\n", "cnc")
    assert spindle.ends == [(10, 2, 0, 0)]


@pytest.mark.parametrize(
    "row",
    [
        r
        for r in table().values()
        if r.code[1:2].isdigit() and " " not in r.code and r.kind is not Kind.MOTION
    ],
)
def test_table_marks_commands_with_a_word_e(row):
    """Text that is not read as words stays as it is."""
    words = [
        name
        for p in row.parameters
        if p.form not in (Form.IGNORED, Form.REFUSED)
        for name in p.names
    ]
    text = f"{row.code} A1E5"
    plain = without_exponents(text)
    if not row.takes_anything:
        stays = row.takes_text or "E" in words or row.code in ("M303", "M306", "M3", "M4", "M5")
        assert plain == (text if stays else f"{row.code} A100000")
    if row.takes_text:
        assert without_exponents(f"{row.code} a1e-05") == f"{row.code} a1e-05"


@pytest.mark.parametrize(
    ("line", "letter"),
    [
        ("G1 X10 X20", "X"),
        ("G1 X10 Y5 E1 E2", "E"),
        ("G1 F600 X1 F300", "F"),
        ("X10 x20", "X"),
        ("G2 X10 I5 I6", "I"),
        ("G92 E0 E1", "E"),
        ("G4 P1 P2", "P"),
        ("M207 S1 S2", "S"),
        ("G1 E1e-05 E1e-05", "E"),
        ("G90 X1 X2", "X"),
    ],
)
def test_a_letter_that_comes_twice_is_an_error(line, letter):
    """Nothing of the command is carried out."""
    out = run(f"M83\n{line}\nG1 X3\n")
    assert [(e[0], e[1], e[2]) for e in out.errors] == [(2, Fault.REPEATED, letter)]
    assert out.ends == [(3, 0, 0, 0)]


@pytest.mark.parametrize("line", ["G1 X5 RXX", "G1 X5 G1 X5", "M117 X1 X1", "G90 G1 X5 G91 X0"])
def test_letters_of_texts_and_of_several_commands_may_come_twice(line):
    out = run(f"{line}\nG90 G1 X5\n")
    assert out.errors == []
    assert out.ends == [(5, 0, 0, 0)]


def test_letters_that_come_twice_in_commands_of_the_printer():
    assert Command(0, "M", 116, 0, "", "T0 T1").check() is None
    assert Command(0, "M", 117, 0, "", "A1 A1").check() is None
    with pytest.raises(WordError, match="more than one S"):
        Command(0, "M", 104, 0, "", "S200 T0 S210").check()


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("123.456", 123.456),
        ("+0.1", 0.1),
        ("000200.0000000", 200.0),
        ("0.0001", 1e-4),
        ("12.3456789012345678901234567890", 12.345678901234568),
        ("1." + "0" * 400, 1.0),
        ("0" * 400 + "7", 7.0),
    ],
)
def test_numbers_are_read_as_written(text, value):
    assert run(f"G1 X{text}\n").moves[0].end_mm[0] == value


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ("G1 X", "X"),
        ("G1 X Y5", "X"),
        ("G1 X-", "X"),
        ("G1 X.", "X"),
        ("G1 X--1", "X"),
        ("G1 Xnan", "X"),
        ("G1 Y+inf", "Y"),
        ("G1 F", "F"),
        ("G92 X", "X"),
        ("G2 X10 I", "I"),
        ("X", "X"),
        ("G4 P", "P"),
        ("G4 S", "S"),
        ("M207 S", "S"),
    ],
)
def test_a_word_without_a_number_is_an_error_that_names_it(line, word):
    out = run(f"G4 P1\n{line}\n")
    assert [(e[0], e[1], e[2]) for e in out.errors] == [(2, Fault.NUMBER, word)]
    assert [m.kind for m in out.moves] == ["dwell"]


@pytest.mark.parametrize(
    "row",
    [
        r
        for r in table().values()
        if r.kind is Kind.MOTION and r.code not in ("G0", "G1") and r.code[1:2].isdigit()
    ],
)
def test_table_marks_letters_without_a_number(row):
    """Of what the core reads itself; R alone is a word of moves."""
    text = "G92 X0 Y0 Z0 E0\nG60\nM302 P1\n"
    alone, absent = set(), set()
    for letter in set("ABCDEHIJKLOPQSTUVWXYZ"):
        errors = [e[:3] for e in run(f"{text}{row.code} {letter}\n").errors]
        if errors == [(4, Fault.LETTER, f"{row.code} {letter} X Y Z E")]:
            absent.add(letter)
        elif errors != [(4, Fault.NUMBER, letter)]:
            assert errors == []
            alone.add(letter)
    assert alone == {name for name, known in row.by_name.items() if known.alone} - absent


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ("G1 X1000000001", "X"),
        ("G1 E-2000000000", "E"),
        ("G1 F1" + "0" * 40, "F"),
        ("G1 X1" + "0" * 400, "X"),
        ("G92 E1000000001", "E"),
        ("G2 X10 I9000000000", "I"),
        ("G4 P1000000001", "P"),
    ],
)
def test_a_word_beyond_1e9_is_an_error_that_names_it(line, word):
    out = run(f"{line}\n")
    assert [(e[1], e[2]) for e in out.errors] == [(Fault.NUMBER, word)]
    assert out.errors[0][4] == 1e9
    assert out.moves == []


@pytest.mark.parametrize(
    "line", ["G1 X5 X-", "G1 X1 Q", "G1 X5 #3", "G1 X[1+2]", "G1 X5 =", "#1=5", "*5", "G", "M"]
)
def test_invalid_words_are_errors(line):
    out = run(f"{line}\n")
    assert len(out.errors) == 1
    assert out.moves == []


@pytest.mark.parametrize("line", ["S12000 M3", "M3 S12000", "M3S12000", "m3 S12000"])
def test_words_before_a_command_belong_to_it(line):
    assert run(line).commands == ["M3 S12000"]


def test_a_tool_word_and_a_command_are_two():
    assert run("T0 M6\n").commands == ["T0", "M6"]
    out = run("T1 M6\n")
    assert [(e[1], e[2], e[3]) for e in out.errors] == [(Fault.MISSING_TOOL, "T", 1)]
    assert out.commands == ["M6"]


def test_several_commands_on_a_line_run_in_order():
    out = run("G91 G1 X5 G90 G1 X1 M104 S200\n")
    assert out.ends == [(5, 0, 0, 0), (1, 0, 0, 0)]
    assert out.commands == ["M104 S200"]


def test_free_text_is_left_alone():
    assert run("M117 G1 X100 Layer 5\nM118 E1 hello\n").commands == [
        "M117 G1 X100 Layer 5",
        "M118 E1 hello",
    ]


@pytest.mark.parametrize(
    "line", ["M117 hello; world", "M118 E1 a (1/2); b", "M117 ; x", "m117 (50%)"]
)
def test_message_goes_up_to_the_end_of_the_line(line):
    kept = [line.replace("m117", "M117")]
    assert run(f"{line}\n").commands == kept
    numbered = f"N5 {line}"
    checksum = reduce(xor, numbered.encode())
    assert run(f"{numbered}*{checksum}\n").commands == kept


@pytest.mark.parametrize(
    ("line", "kept"),
    [
        ("RESPOND MSG='hello; world' ; all", "RESPOND MSG='hello; world'"),
        ('RESPOND MSG="it\'s; here" TYPE=echo', 'RESPOND MSG="it\'s; here" TYPE=echo'),
        ("RESPOND MSG=hello; world", "RESPOND MSG=hello"),
        ("M1170 a; b", "M1170 a"),
        ("M104 S2 M117 a; b", "M104 S2"),
    ],
)
def test_text_of_other_commands_ends_at_a_comment(line, kept):
    assert run(f"{line}\n").commands[0] == kept


def test_extended_commands_are_events_with_their_text():
    out = run("SET_VELOCITY_LIMIT ACCEL=500\nset_fan_speed FAN=a SPEED=.5 ; c\n_CUSTOM A=1\n")
    assert out.commands == [
        "SET_VELOCITY_LIMIT ACCEL=500",
        "SET_FAN_SPEED FAN=a SPEED=.5",
        "_CUSTOM A=1",
    ]


def test_unknown_codes_are_events_with_line_number():
    assert run("\nM999 P1\nG12.1 X3\n").events == [
        (2, "M", 999, 0, "", "P1"),
        (3, "G", 12, 1, "", "X3"),
    ]


def test_commands_of_a_line_start_where_the_last_ended():
    out = run("G91 G1 X5 G1 X5 G92 X0 G90 G1 X1 G2 X3 I1 G1 G91 X1\n")
    assert out.errors == []
    assert out.ends[:3] == [(5, 0, 0, 0), (10, 0, 0, 0), (11, 0, 0, 0)]
    assert out.ends[-2:] == [(13, 0, 0, 0), (14, 0, 0, 0)]
    assert {m.line for m in out.moves} == {1}


@pytest.mark.parametrize(
    ("line", "fault", "word"),
    [
        ("G1 X1 F0", Fault.FEEDRATE, "F"),
        ("G1 F-5", Fault.FEEDRATE, "F"),
        ("G1 X1 F-5", Fault.FEEDRATE, "F"),
        ("M207 F0", Fault.FEEDRATE, "F"),
        ("G60 S0.5", Fault.NUMBER, "S"),
        ("G2 X10 I5 P100000000", Fault.RANGE, "P"),
        ("M99999999999999999999", Fault.NUMBER, "M"),
        ("G99999999999999999999 X1", Fault.NUMBER, "G"),
        ("T99999999999999999999", Fault.NUMBER, "T"),
    ],
)
def test_impossible_numbers_are_errors(line, fault, word):
    out = run(f"G1 X1\nX5 Y5\n{line}\n")
    assert [e[:3] for e in out.errors] == [(3, fault, word)]
    assert len(out.moves) == 2


@pytest.mark.parametrize(
    ("line", "word", "value", "least", "most"),
    [
        ("M207 S-2", "S", -2, 0, 5000),
        ("M207 S5001", "S", 5001, 0, 5000),
        ("M207 S1 Z-0.4", "Z", -0.4, 0, 5000),
        ("M207 W-1", "W", -1, 0, 5000),
        ("M207 R-5000.5", "R", -5000.5, -5000, 5000),
        ("M208 S-6000", "S", -6000, -5000, 5000),
        ("M208 W6000", "W", 6000, -5000, 5000),
        ("M603 L-1", "L", -1, 0, 5000),
        ("M702 U5001", "U", 5001, 0, 5000),
        ("M200 D0.05", "D", 0.05, 0.1, 10),
        ("G4 S1000001", "S", 1000001, 0, 1e6),
        ("G60 S2", "S", 2, 0, 1),
    ],
)
def test_values_out_of_range_are_errors(line, word, value, least, most):
    out = run(f"G1 X1\nX5 Y5\n{line}\n")
    assert out.errors == [(3, Fault.RANGE, word, value, most)]
    assert out.points == [(least, 0, 0)]
    assert len(out.moves) == 2


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("S200 F", [("S", 200, "200"), ("F", None, None)]),
        ('P "a S5" x-.5', [("P", None, "a S5"), ("X", -0.5, "-.5")]),
        ("S1 (P2 (T3) F) R+4.", [("S", 1, "1"), ("R", 4, "+4.")]),
        ('S,é"', [("S", None, None), (",", None, None), ("é", None, None), ('"', None, None)]),
    ],
)
def test_texts_of_handlers_are_divided_into_words(text, words):
    assert split_text(text) == words


def test_nan_is_a_number_of_its_letter():
    ((letter, number, text), (other, _, _)) = split_text("Snan T")
    assert (letter, text, other) == ("S", "nan", "T")
    assert number is not None and isnan(number)


@pytest.mark.parametrize(
    ("machine", "line", "command"),
    [
        ("i3", "G1 H2 X5 F60", "G1 H2 X5.000000 F60.000000"),
        ("i3", "g0 h1 x-5", "G1 H1 X-5.000000"),
        ("corexy", "N3 G1 A5", "G1 A A5.000000"),
        ("corexy", "G91 G1 B0", "G1 A0"),  # G1 is not the first command
        ("corexy", "G1 X1 A0", "G1 A0"),
        ("i3", "G1 H0 X5", None),
        ("cnc", "G43 H2 Z15", None),
        ("cnc", "G43 G0 H2 Z15", None),
        ("cnc", "G0 G43 Z15 H2", None),
    ],
)
def test_motors_move_only_after_a_move_requests_it(machine, line, command):
    """H is the number of a tool after G43, and A an axis of other machines."""
    out = run(f"{line}\n", machine)
    assert out.errors == []
    found = [c.strip() for c in out.commands if c.startswith("G1 ")]
    assert found == ([command] if command else [])


def test_kinds_of_raw_moves_that_do_not_exist_are_refused():
    out = run("G1 H3 X5\n", "i3")
    assert [error[1] for error in out.errors] == [Fault.RANGE]


@pytest.mark.parametrize(
    ("machine", "line", "word"),
    [
        ("i3", "G1 Q5", "G1 Q X Y Z E"),
        ("i3", "G1 U5 X1 Y1", "G1 U X Y Z E"),
        ("i3", "g0 x1 w0", "G0 W X Y Z E"),
        ("i3", "G1 A5", "G1 A X Y Z E"),
        ("i3", "G1 R1 X0 Y0", "G1 R X Y Z E"),  # a saved position, in RepRapFirmware
        ("i3", "G1 X1 I5 J5", "G1 I X Y Z E"),
        ("i3", "G2 X10 Y0 I5 Q1", "G2 Q X Y Z E"),
        ("i3", "G90 G1 H2 X1", "G1 H X Y Z E"),
        ("i3", "X1 D5", "G1 D X Y Z E"),
        ("i3", "G60 X1", None),
        ("i3", "G60 Q1", "G60 Q X Y Z E"),
        ("i3", "G61 U", "G61 U X Y Z E"),
        ("i3", "G92 X5 Q0", "G92 Q X Y Z E"),
        ("corexy", "G91 G1 B-2.5", "G1 B X Y Z E"),
        ("corexy", "G1 X1 A5", "G1 A X Y Z E"),
        ("corexy", "G92 A5", None),
        ("cnc", "G1 X1 E5", "G1 E X Y Z"),
        ("cnc", "G92 E5", "G92 E X Y Z"),
    ],
)
def test_a_letter_that_names_no_axis_is_refused(machine, line, word):
    out = run(f"G1 X7 F600\nG60\n{line}\nG1 X8\n", machine)
    refused = [(3, Fault.LETTER, word)] if word else []
    assert [e[:3] for e in out.errors] == refused
    assert [end[:3] for end in out.ends] == [(7, 0, 0), (15 if "G91" in line else 8, 0, 0)]


@pytest.mark.parametrize(
    ("machine", "lines", "codes"),
    [
        ("i3", "G0 X1 A0\nG1 X2 A0. B-0\nX3 C0\n", ["G1 A0"] * 3),
        ("cnc", "G92 E0\nG1 X1\nG92 E0\nX2\nX3\n", ["G1 A0"]),
        ("corexy", "G92 B0\nG1 X1 B0\nX2\nX3 B0\n", ["G92.1", "G1 A0"]),
    ],
)
def test_axes_at_zero_that_are_missing_are_reported_once(machine, lines, codes):
    out = run(f"G1 F600\n{lines}", machine)
    assert out.errors == []
    assert [command.partition(" B")[0] for command in out.commands] == codes
    assert [end[0] for end in out.ends] == [1, 2, 3]


def test_a_feedrate_of_zero_without_a_move_changes_nothing():
    """As Fusion 360 writes it: the feedrate before it stays."""
    out = run("G1 X10 F600\nG1 F0\nG0 Y10\nF0\nG1 X0 Y0\nX1 F0\n")
    assert [e[:3] for e in out.errors] == [(6, Fault.FEEDRATE, "F")]
    assert [m.cruise_speed for m in out.moves] == [10, 10, 10]
