"""Canned cycles move as RS274 and LinuxCNC define them."""

from __future__ import annotations

import pytest
from tests.gcode.driver import run

from passo._core import Fault

F = "G21 G90 F60\n"  # 1 mm/s


def slow(move):
    return move.speed_cap < 1.001


def ends(out):
    """X, Y, Z of each move; `*` behind those at the feedrate, `w` for a dwell."""
    return [
        "w"
        if move.kind == "dwell"
        else " ".join(f"{round(v, 6) + 0.0:g}" for v in move.end_mm[:3]) + "*" * slow(move)
        for move in out.moves
    ]


def drilled(text, machine="unbounded"):
    out = run(F + text, machine)
    assert out.errors == []
    assert out.events == []
    return ends(out)


AT = "G0 X1 Y2 Z3 F6000\nF60\n"  # as in RS274's examples


def test_g81_drills_as_in_rs274():
    assert drilled(AT + "G90 G81 G98 X4 Y5 Z1.5 R2.8")[-4:] == [
        "4 5 3", "4 5 2.8", "4 5 1.5*", "4 5 3",
    ]  # fmt: skip


def test_g81_repeats_as_in_rs274():
    assert drilled(AT + "G91 G81 G98 X4 Y5 Z-0.6 R1.8 L3")[-10:] == [
        "1 2 4.8",
        "5 7 4.8", "5 7 4.2*", "5 7 4.8",
        "9 12 4.8", "9 12 4.2*", "9 12 4.8",
        "13 17 4.8", "13 17 4.2*", "13 17 4.8",
    ]  # fmt: skip


CYCLES = {
    "G81 X9 Z0 R2": ["9 0 5", "9 0 2", "9 0 0*", "9 0 5"],
    "G99 G81 X9 Z0 R2": ["9 0 5", "9 0 2", "9 0 0*", "9 0 2"],
    "G81 G99 X9 Z0 R2": ["9 0 5", "9 0 2", "9 0 0*", "9 0 2"],
    "G82 X9 Z0 R2 P0.5": ["9 0 5", "9 0 2", "9 0 0*", "w", "9 0 5"],
    "G82 X9 Z0 R2": ["9 0 5", "9 0 2", "9 0 0*", "9 0 5"],
    "G83 X9 Z0 R2 Q0.8": [
        "9 0 5", "9 0 2", "9 0 1.2*", "9 0 2", "9 0 1.454", "9 0 0.4*", "9 0 2", "9 0 0.654",
        "9 0 0*", "9 0 5",
    ],
    "G73 X9 Z0 R2 Q0.8": [
        "9 0 5", "9 0 2", "9 0 1.2*", "9 0 1.454", "9 0 0.4*", "9 0 0.654", "9 0 0*", "9 0 5",
    ],
    "G83 X9 Z0 R2 Q2": ["9 0 5", "9 0 2", "9 0 0*", "9 0 5"],
    "G81 X9 Z0 R7": ["0 0 7", "9 0 7", "9 0 0*", "9 0 7"],  # R above where it was
    "G81 Z0 R2": ["0 0 2", "0 0 0*", "0 0 5"],
    "G81 X9 Z0 R2 L2": ["9 0 5", "9 0 2", "9 0 0*", "9 0 5", "9 0 2", "9 0 0*", "9 0 5"],
    "G81 X9 Z0 R2 K0": [],
    "G91 G81 X1 Z-1 R-3 K2": [
        "1 0 5", "1 0 2", "1 0 1*", "1 0 5", "2 0 5", "2 0 2", "2 0 1*", "2 0 5",
    ],
    "G91 G99 G81 X1 Z-1 R-3 L2": ["1 0 5", "1 0 2", "1 0 1*", "1 0 2", "2 0 2", "2 0 1*", "2 0 2"],
    "G20 G81 X1 Z0 R.1": ["25.4 0 5", "25.4 0 2.54", "25.4 0 0*", "25.4 0 5"],
    "G18 G81 X9 Z4 Y-2 R1": ["0 1 5", "9 1 4", "9 -2 4*", "9 1 4"],
    "G19 G81 Y9 Z4 X-2 R-1": ["0 9 4", "-1 9 4", "-2 9 4*", "0 9 4"],
}  # fmt: skip


@pytest.mark.parametrize(("text", "moves"), CYCLES.items())
def test_each_cycle_makes_its_moves(text, moves):
    found = drilled("G0 Z5\n" + text.replace("G20 ", "G20\nF2.36220472440945\n"))
    assert found[0] == "0 0 5*"  # G0 keeps to F here
    assert found[1:] == moves


def test_words_stay_in_force_until_g80():
    text = "G0 Z5\nG81 X1 Y1 Z-2 R2\nX2\nY3 Z-1\nG99\nX4 R1\nG80\nX5 Y5 Z5\n"
    assert drilled(text)[1:] == [
        "1 1 5", "1 1 2", "1 1 -2*", "1 1 5",
        "2 1 5", "2 1 2", "2 1 -2*", "2 1 5",
        "2 3 5", "2 3 2", "2 3 -1*", "2 3 5",
        "4 3 5", "4 3 1", "4 3 -1*", "4 3 1",
        "5 5 5*",
    ]  # fmt: skip


def test_the_level_of_g98_is_that_before_the_first_cycle():
    text = "G0 Z5\nG99 G81 X1 Z-2 R2\nG98 X2\nG82 X3 Z-2 R1\nG0 Z3\nG81 X4 Z-2 R1\n"
    assert [end.split()[2] for end in drilled(text) if "*" not in end and end.startswith("2")] == [
        "2", "5",
    ]  # fmt: skip
    assert drilled(text)[-1] == "4 0 3"


def test_a_feedrate_alone_drills_nothing():
    text = "G0 Z5\nG81 X1 Z-2 R2\nF120\nX2\n"
    out = run(F + text, "unbounded")
    assert [round(m.speed_cap, 6) for m in out.moves if m.speed_cap < 3] == [1, 1, 2]


def test_offsets_of_g92_and_tools_count():
    assert drilled("G0 Z5\nG92 X100 Z0\nG81 X101 Z-5 R-1\n")[1:] == [
        "1 0 5", "1 0 4", "1 0 0*", "1 0 5",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "fault", "word"),
    [
        ("G81 X1 R2", Fault.MISSING_WORD, "G81 Z"),
        ("G81 X1 Z-2", Fault.MISSING_WORD, "G81 R"),
        ("G81 R2", Fault.MISSING_WORD, "G81 X, Y or Z"),
        ("G83 X1 Z-2 R2", Fault.MISSING_WORD, "G83 Q"),
        ("G81 X1 Z-2 R2\nG83 X2 Q1", Fault.MISSING_WORD, "G83 Z"),
        ("G81 X1 Z-2 R2\nG80\nG81 X2", Fault.MISSING_WORD, "G81 Z"),
        ("G19 G81 Y1 Z1 R2", Fault.MISSING_WORD, "G81 X"),
        ("G83 X1 Z-2 R2 Q0", Fault.RANGE, "Q"),
        ("G83 X1 Z-2 R2 Q-1", Fault.RANGE, "Q"),
        ("G83 X1 Z-2 R2 Q0.000001", Fault.RANGE, "Q"),
        ("G81 X1 Z2 R1", Fault.RANGE, "R"),
        ("G81 X1 Z0 R1 L-1", Fault.RANGE, "L"),
        ("G81 X1 Z0 R1 L1e", Fault.NUMBER, "E"),
        ("G81 X1 Z0 R1 L1.5", Fault.NUMBER, "L"),
        ("G81 X1 Z0 R1 K100000", Fault.RANGE, "K"),
        ("G82 X1 Z0 R1 P-1", Fault.RANGE, "P"),
        ("G81 X1 Z0 R1 E5", Fault.WORD, "E"),
        ("G81 X1 Z0 R1 I5", Fault.WORD, "I"),
        ("G81 X1 Z0 R", Fault.NUMBER, "R"),
    ],
)
def test_wrong_cycles_move_nothing(text, fault, word):
    out = run(F + "G0 Z5\n" + text, "unbounded")
    assert [(e[1], e[2]) for e in out.errors] == [(fault, word)]
    drilled = text.count("G81 X1 Z-2 R2\n") * 4
    assert len(out.moves) == 1 + drilled


def test_without_a_feedrate_nothing_is_drilled():
    out = run("G81 X1 Z-2 R2", "unbounded")
    assert [(e[1], e[2]) for e in out.errors] == [(Fault.MISSING_WORD, "G81 F")]


@pytest.mark.parametrize(
    ("text", "axis", "value"),
    [
        ("G81 X9 Z-31 R2", "z", -31),
        ("G81 X201 Z-3 R2", "x", 201),
        ("G91 G81 X50 Z-3 R-1 L5", "x", 250),
        ("G81 X9 Z-3 R51", "z", 51),
    ],
)
def test_a_cycle_beyond_the_limits_moves_nothing(text, axis, value):
    out = run(F + text, "cnc")
    assert [(e[1], e[2], e[3]) for e in out.errors] == [(Fault.OUT_OF_RANGE, axis, value)]
    assert out.moves == []
    clamped = run(F + text, "cnc", clamp=True)
    assert clamped.errors == []
    assert min(m.end_mm[2] for m in clamped.moves) >= -30


def test_many_repeats_take_no_memory_of_their_own():
    out = run(F + "G91 G83 X0.001 Z-1 R0 Q0.01 L1000", "unbounded")
    assert len([m for m in out.moves if slow(m)]) == 100_000


def test_g80_alone_means_levelling_only_for_printers():
    assert run("G80", "cnc").commands == []
    assert run("G17 G21 G40 G49 G80 G90", "cnc").commands == ["G40", "G49"]
    assert run("G80", "i3").commands == ["G80"]
    assert run(F + "G81 X1 Z1 R2\nG80", "i3").commands == []


@pytest.mark.parametrize("chunk", [1, 7])
def test_a_cycle_does_not_depend_on_how_the_text_is_cut(chunk):
    text = F + "G0 Z5\nG83 X1 Y1 Z-2 R2 Q1.5\nX2 L2\nG80\n"
    assert run(text, "unbounded", chunk).ends == run(text, "unbounded").ends
