"""Whole streams: chunks, hostile bytes, and plain moves against an independent reader."""

from __future__ import annotations

import re
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from passo._core import Fault, Job, JobStatus

from .driver import Outcome, run, spec

BOM = b"\xef\xbb\xbf"
LONGEST = 65536  # bytes of a line, comment not counted
PROGRAM = """%
; a comment
N1 G21*45
N1 G21*23
G28
M104 S200
G1 X10 Y10 F3000 E1 ; words
g1x20y20e2(x99)
X30
G2 X40 I5
G4 P100
SET_FAN_SPEED FAN=a SPEED=1
M117 a text ; b
G1 X1E5
G1 X
G1 X999
G91 G1 X1 G1 X1
T0
G10
G11
G1 X5 Y5"""


def summary(out: Outcome):
    moves = [(m.line, m.start_mm, m.end_mm, m.start_ticks, m.end_ticks) for m in out.moves]
    return moves, out.events, out.errors, out.statistics


@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize("chunk", [1, 2, 3, 7, 64])
def test_result_does_not_depend_on_chunks(end, chunk):
    data = PROGRAM.replace("\n", end)
    assert summary(run(data, chunk=chunk)) == summary(run(data))


@settings(max_examples=60, derandomize=True, deadline=None)
@given(data=st.binary(max_size=300), chunk=st.integers(1, 20))
def test_any_bytes_in_any_chunks(data, chunk):
    assert summary(run(data, chunk=chunk)) == summary(run(data))


@settings(max_examples=300, derandomize=True, deadline=None)
@given(st.lists(st.text("GMTXYZEFIJRPNS0123456789.-+ ;()*%#=gxn_\n\r\t", max_size=30), max_size=10))
def test_any_line_leaves_the_machine_in_its_bounds(lines):
    out = run("\n".join(lines), clamp=True, ignore_tools=True)
    for move in out.moves:
        x, y, z = move.end_mm[:3]
        assert -1e-6 <= x <= 250 + 1e-6
        assert -1e-6 <= y <= 220 + 1e-6
        assert -1e-6 <= z <= 250 + 1e-6
    for a, b in pairwise(out.moves):
        assert a.end_mm[:3] == b.start_mm[:3]


@pytest.mark.parametrize(
    "line", [b"G1 X5\0Y5", b"\0G1", b"G1\x01X5", b"\x7fELF\x02\x01\x01", b"\0\0\x01\0" * 100]
)
def test_control_characters_are_garbage(line):
    out = run(b"G1 X1\n" + line + b"\nG1 X2\n")
    assert [e[:2] for e in out.errors] == [(2, Fault.GARBAGE)]
    assert out.ends == [(1, 0, 0, 0), (2, 0, 0, 0)]


@pytest.mark.parametrize("head", [b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", b"\xff\xd8\xff\xe0\0\x10JFIF"])
def test_a_picture_is_garbage(head):
    assert run(head).errors[0][:2] == (1, Fault.GARBAGE)


def test_text_beyond_ascii_is_allowed_in_comments_and_messages():
    out = run("G1 X1 ; 30 °C\n(µm) G1 X2\nM117 schön\n;LAYER:0 ß\n")
    assert out.errors == []
    assert out.ends == [(1, 0, 0, 0), (2, 0, 0, 0)]
    assert out.commands == ["M117 schön"]


@pytest.mark.parametrize("chunk", [0, 50_000])
def test_a_line_of_10_mb(chunk):
    out = run(b"G1 X1\n" + b"G1 X2 " * 1_700_000 + b"\nG1 X3\n", chunk=chunk)
    assert [e[:2] for e in out.errors] == [(2, Fault.LINE_TOO_LONG)]
    assert out.ends == [(1, 0, 0, 0), (3, 0, 0, 0)]


@pytest.mark.parametrize("mark", [b"", BOM])
@pytest.mark.parametrize("end", [b"", b"\n", b"\r\nG1 X3\n", b";\nG1 X3"])
def test_a_line_that_is_too_long_is_reported_before_its_end(mark, end):
    job, status = Job(spec("i3"), False), JobStatus
    job.feed(mark + b"G1 X" + b"1" * (LONGEST - 4))
    assert job.advance() == status.NEED_INPUT
    job.feed(b"1")
    assert job.advance() == status.ERROR
    assert job.error[:2] == (1, Fault.LINE_TOO_LONG)
    for _ in range(3):
        job.feed(b";1" * LONGEST)
        assert job.advance() == status.NEED_INPUT
    job.feed(end)
    job.finish()
    assert job.advance() == status.END
    assert job.line == (2 if b"X3" in end else 1)


@pytest.mark.parametrize("chunk", [0, 50_000])
def test_a_comment_of_10_mb(chunk):
    out = run(b"G1 X1\nG1 X2 ;" + b"x" * 10_000_000 + b"\nG1 X3\n", chunk=chunk)
    assert out.errors == []
    assert out.ends == [(1, 0, 0, 0), (2, 0, 0, 0), (3, 0, 0, 0)]


def test_empty_program_has_no_moves():
    for text in ("", "\n", "\r\n\r\n", ";", "%", "()", "  \t"):
        out = run(text)
        assert (out.moves, out.events, out.errors) == ([], [], [])


def test_a_last_line_without_an_end_counts():
    assert run("G1 X1\nG1 X2").ends == [(1, 0, 0, 0), (2, 0, 0, 0)]
    assert run("G1 X1\nG1 X2").statistics["lines"] == 2


def read_plain(text):
    """Ends of the moves of G0, G1, G90, G91, M82, M83 and G92, by regular expressions."""
    at, origin, e_zero = dict.fromkeys("XYZE", 0.0), dict.fromkeys("XYZ", 0.0), 0.0
    absolute = absolute_e = True
    ends = []
    for line in text.splitlines():
        code, rest = re.match(r"([GM]\d+)(.*)", line).groups()
        words = {w: float(v) for w, v in re.findall(r"([XYZE])(-?[\d.]+)", rest)}
        if code in ("G90", "G91"):
            absolute = code == "G90"
        elif code in ("M82", "M83"):
            absolute_e = code == "M82"
        elif code == "G92":
            for w, v in words.items():
                if w == "E":
                    e_zero = at["E"] - v
                else:
                    origin[w] = at[w] - v
        else:
            before = dict(at)
            for w, v in words.items():
                if w == "E":
                    at["E"] = v + e_zero if absolute and absolute_e else at["E"] + v
                else:
                    at[w] = v + origin[w] if absolute else at[w] + v
            if any(abs(at[w] - before[w]) > 1e-7 for w in at):
                ends.append(tuple(at.values()))
    return ends


number = st.integers(-9999, 9999).map(lambda n: f"{n / 1000:.3f}")
word = st.tuples(st.sampled_from("XYZE"), number).map("".join)
words = st.lists(word, max_size=4, unique_by=lambda w: w[0]).map(" ".join)
command = st.one_of(
    st.tuples(st.sampled_from(["G0 ", "G1 ", "G1 F600 ", "G1", "G92 "]), words).map("".join),
    st.sampled_from(["G90", "G91", "M82", "M83"]),
)


@settings(max_examples=300, derandomize=True, deadline=None)
@given(st.lists(command, max_size=30).map("\n".join))
def test_plain_moves_are_what_an_independent_reader_finds(text):
    text = text.replace("G92 \n", "G90\n").removesuffix("G92 ")
    out = run(text, "unbounded")
    assert out.errors == []
    expected = read_plain(text)
    assert len(out.moves) == len(expected)
    for move, end in zip(out.moves, expected, strict=True):
        assert move.end_mm[:4] == pytest.approx(end, abs=1e-9)


HOSTILE = [
    *b"G1 X5 Y5|G0X1Y2|X10|N5 G1 X3*|*93|;|;LAYER:3|;TYPE:Wall|(|)|%|/|$H|@p".split(b"|"),
    *b"M117 hi |T0|T1 M6|G2 X10 I5|G91|G90|G53 |G54 X3|G28|O100|g1x5e.5f600".split(b"|"),
    *b"G10|G11|M104 S200|G92 X0|SET_VELOCITY_LIMIT ACCEL=1000|1e5|-|.".split(b"|"),
    *(b"N1 G21*45", b"9" * 20, BOM, b"\xff", b"\0", b"\xc3\xa9"),
    *(b"\r", b"\n", b"\r\n", b"\n\r", b" ", b"\t"),
]
fill = st.sampled_from([b"x", b"G1 X1 ", b"; ", b"(", b"\xc3"])
pieces = st.one_of(
    *[st.sampled_from(HOSTILE)] * 20,
    st.binary(max_size=3),
    st.builds(lambda text, n: (text * n)[:n], fill, st.integers(65530, 65542)),  # the longest line
)


@settings(max_examples=400, derandomize=True, deadline=None)
@given(
    data=st.lists(pieces, max_size=40).map(b"".join),
    cuts=st.lists(st.integers(0, 2**20), max_size=30),
)
def test_hostile_text_in_random_chunks(data, cuts):
    at = sorted({0, len(data), *(cut % (len(data) + 1) for cut in cuts)})
    chunks = [data[a:b] for a, b in pairwise(at)]
    policy = {"clamp": True, "ignore_tools": True}
    assert summary(run(chunks, **policy)) == summary(run(data, **policy))


@pytest.mark.parametrize("mark", [b"", BOM])
@pytest.mark.parametrize("length", range(65534, 65542))
@pytest.mark.parametrize("tail", [b"", b"\0", b"\xff*1", b";TYPE:b"])
def test_rest_of_long_line_does_not_depend_on_chunks(mark, length, tail):
    data = mark + (b"N1 G1 X5*93 ;" + b"c" * 70_000)[:length] + tail + b"\nG1 X7\n"
    whole = summary(run(data))
    assert whole == summary(run([data[:65_538], data[65_538:]]))
    assert whole == summary(run([data[:66_000], data[66_000:]]))
    assert whole == summary(run(data, chunk=7001))
