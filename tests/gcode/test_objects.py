"""Objects of a print that are cancelled: what is still printed, against a reader of the text in
plain Python, and how the machine gets from one to the next."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import pytest
from tests.gcode.driver import Outcome, run, spec
from tests.oracles.objects import Reading, read
from tests.scenarios.test_extruder_axes import text as machine_without_tools

from passo._core import Fault, Job, JobStatus, ObjectAction, object_orders
from passo.config import load


def checked(text: str, *cancelled: int | str) -> Outcome:
    """Runs a program whose first line cancels these objects, and compares it with the oracle."""
    orders = [
        f"M486 P{name}" if isinstance(name, int) else f'EXCLUDE_OBJECT NAME="{name}"'
        for name in cancelled
    ]
    out = run("".join(f"{order}\n" for order in orders) + text, "unbounded", surveyed=True)
    assert out.errors == []
    check(out.moves, read("\n" * len(orders) + text, cancelled))
    return out


def check(moves: list[Any], wanted: Reading) -> None:
    """Live lines lay the same filament in the same places, cancelled ones nothing; the filament is
    drawn back as in the program wherever a line is printed, and no less on the way across."""
    printed, drawn, e = [], 0.0, moves[0].start_mm[3]
    for i, move in enumerate(moves):
        start, end = move.start_mm, move.end_mm
        line = move.line
        assert line not in wanted.skipped
        assert start[3] == pytest.approx(e, abs=1e-9)
        e = end[3]
        mm = end[3] - start[3]
        across = start[:2] != end[:2]
        last = i + 1 == len(moves) or moves[i + 1].line != line
        if mm > 1e-9 and start[:3] != end[:3]:
            assert last
            assert drawn == pytest.approx(wanted.drawn_mm[line], abs=1e-6)
            printed.append((line, start[:3], end[:3], mm))
        elif across:
            assert drawn >= wanted.drawn_mm[line] - 1e-6, f"line {line}"
        drawn = max(0.0, drawn - mm)
    assert [p[0] for p in printed] == [p.line for p in wanted.printed]
    for found, want in zip(printed, wanted.printed, strict=True):
        assert found[1] == pytest.approx(want.start, abs=1e-6), f"line {want.line}"
        assert found[2] == pytest.approx(want.end, abs=1e-6)
        assert found[3] == pytest.approx(want.filament_mm, abs=1e-6)
    if all(wanted.drawn_mm[p.line] < 1e-6 for p in wanted.printed):
        laid = sum(p.filament_mm for p in wanted.printed)
        assert e - moves[0].start_mm[3] == pytest.approx(laid - drawn, abs=1e-6)


def ends(out: Outcome) -> list[tuple[float, ...]]:
    return [tuple(round(v, 4) for v in m.end_mm[:4]) for m in out.moves]


BLOCKS = """\
G92 E0
M83
G1 X10 Y10 Z0.2 F6000
EXCLUDE_OBJECT_START NAME=a
G1 X20 E1 F1200
EXCLUDE_OBJECT_END NAME=a
EXCLUDE_OBJECT_START NAME=b
G1 E-2 F2400
G1 Z0.6 F9000
G1 X40 Y40
G1 Z0.2
G1 E2 F2400
G1 X50 E1 F1200
EXCLUDE_OBJECT_END NAME=b
EXCLUDE_OBJECT_START NAME=c
G1 E-2 F2400
G1 Z0.6 F9000
G1 X70 Y70
G1 Z0.2
G1 E2 F2400
G1 X80 E1 F1200
EXCLUDE_OBJECT_END NAME=c
"""


def test_the_head_goes_straight_to_the_next_live_object():
    out = checked(BLOCKS, "b")
    assert ends(out) == [
        (10, 10, 0.2, 0),
        (20, 10, 0.2, 1),
        (20, 10, 0.2, -1),
        (20, 10, 0.6, -1),
        (70, 70, 0.6, -1),
        (70, 70, 0.2, -1),
        (70, 70, 0.2, 1),
        (80, 70, 0.2, 2),
    ]
    assert [round(m.speed_cap) for m in out.moves[1:]] == [20, 40, 12, 150, 12, 40, 20]


@pytest.mark.parametrize("cancelled", ["a", "b", "c", "ab", "bc", "ac", "abc"])
@pytest.mark.parametrize("relative", [True, False])
def test_any_choice_of_objects_prints_the_others(cancelled: str, relative: bool):
    text = BLOCKS if relative else absolute(BLOCKS)
    checked(text + "G1 Z50 F600\n", *cancelled)


def absolute(text: str) -> str:
    """The same program with absolute E."""
    e, lines = 0.0, []
    for line in text.replace("M83", "M82").splitlines():
        words = line.split()
        for i, word in enumerate(words):
            if word[0] == "E" and word[1:].lstrip("-").isdecimal():
                e += float(word[1:])
                words[i] = f"E{e:g}"
        lines.append(" ".join(words))
    return "\n".join(lines) + "\n"


BORDERS = {
    "retracted before the object, primed in it": (
        "G1 E-2\nSTART b\nG1 X40 Y40\nG1 E2\nG1 X50 E1\nEND b\nG1 E-2\nSTART c\nG1 X70\nG1 E2\n"
        "G1 X80 E1\nEND c\n"
    ),
    "retracted at the end of the object, primed after it": (
        "START b\nG1 X40\nG1 X50 E1\nG1 E-2\nEND b\nG1 X70\nG1 E2\nSTART c\nG1 X80 E1\nEND c\n"
    ),
    "retracted before it, and never after": (
        "G1 E-2\nSTART b\nG1 X40 Y40\nG1 E2\nG1 X50 E1\nEND b\nSTART c\nG1 X80 E1\nEND c\n"
    ),
    "retracted within it, and primed by the first line": (
        "START b\nG1 X40\nG1 E-2\nEND b\nSTART c\nG1 E2\nG1 X80 E1\nEND c\n"
    ),
    "wiped while it travels": (
        "START b\nG1 X40\nG1 X50 E1\nG1 X48 E-1.5\nG1 E-0.5\nEND b\nG1 Y70\nG1 E2\nSTART c\n"
        "G1 X80 E1\nEND c\n"
    ),
    "printed at once": "START b\nG1 X40\nG1 X50 E1\nEND b\nSTART c\nG1 X80 E1\nEND c\n",
    "by firmware": (
        "START b\nG10\nG1 X40\nG11\nG1 X50 E1\nEND b\nSTART c\nG10\nG1 X70\nG11\nG1 X80 E1\nEND c\n"
    ),
    "by firmware across the border": (
        "G10\nSTART b\nG1 X40\nG11\nG1 X50 E1\nG10\nEND b\nSTART c\nG1 X70\nG11\nG1 X80 E1\nEND c\n"
    ),
    "firmware and slicer": (
        "G10\nSTART b\nG11\nG1 X50 E1\nEND b\nSTART c\nG1 E-2\nG1 X70\nG1 E2\nG1 X80 E1\nEND c\n"
    ),
    "deeper after it": (
        "G1 E-2\nSTART b\nG1 E2\nG1 X50 E1\nG1 E-1\nEND b\nG1 E-3\nSTART c\nG1 X70\nG1 E4\n"
        "G1 X80 E1\nEND c\n"
    ),
    "its zero moves": (
        "START b\nG92 X0 Y0 E0\nG1 X5 E1\nG92 E7\nEND b\nSTART c\nG1 X8\nG1 Y3 E1\nEND c\n"
    ),
    "modes change": (
        "START b\nG91\nG1 X5 E1\nG20\nEND b\nSTART c\nG1 X1\nG21\nG1 Y3 E1\nG90\nG1 X3 Y3 E1\n"
        "END c\n"
    ),
}


@pytest.mark.parametrize("border", BORDERS.values(), ids=BORDERS)
@pytest.mark.parametrize("marks", ["names", "numbers"])
def test_filament_is_drawn_back_as_the_program_means(border: str, marks: str):
    text = "M83\nG1 X10 F6000\nG1 X20 E1 F1200\n" + border + "G1 Z20\nG1 E-1\nG1 X0\n"
    if marks == "names":
        text = text.replace("START ", "EXCLUDE_OBJECT_START NAME=")
        text = text.replace("END ", "EXCLUDE_OBJECT_END NAME=")
        checked(text, "b")
        checked(text, "b", "c")
        return
    text = text.replace("START b", "M486 S0").replace("START c", "M486 S1")
    text = text.replace("END b", "M486 S-1").replace("END c", "M486 S-1")
    checked(text, 0)
    checked(text, 0, 1)


@pytest.mark.parametrize("seed", range(60))
def test_random_programs_skip_cancelled_objects(seed: int):
    rnd = random.Random(seed)
    lines = ["M83", "G1 Z0.2 F9000"]
    names = "abc"
    drawn, firmware = 0.0, False
    for _ in range(rnd.randrange(4, 14)):
        marker = f"EXCLUDE_OBJECT_START NAME={rnd.choice(names)}"
        body = []
        begin_at = rnd.randrange(4)  # where the marker stands in the way to the object
        if drawn == 0 and not firmware and rnd.random() < 0.7:
            firmware = rnd.random() < 0.4
            drawn = 0.0 if firmware else 2.0
            body.append("G10" if firmware else "G1 E-2 F2400")
        else:
            body.append("; nothing")
        body.append(rnd.choice(["; nothing", "G1 Z0.8", "G91\nG1 Z0.4\nG90"]))
        body.append(f"G1 X{rnd.randrange(200)} Y{rnd.randrange(200)} F9000")
        body.append("G1 Z0.2")
        lines += [*body[:begin_at], marker, *body[begin_at:]]
        if firmware or drawn:
            lines.append("G11" if firmware else f"G1 E{drawn:g} F2400")
            drawn, firmware = 0.0, False
        for _ in range(rnd.randrange(1, 4)):
            lines.append(
                f"G1 X{rnd.randrange(200)} Y{rnd.randrange(200)} E{rnd.random():.3f} F1200"
            )
        lines.append(rnd.choice(["G92 E0", "G92 X50", "G92 E3 X1 Y2", "; nothing", "; nothing"]))
        if rnd.random() < 0.6:
            lines.append("EXCLUDE_OBJECT_END")
    lines += ["EXCLUDE_OBJECT_END", "G1 E-1 F2400", "G1 Z30 F900", "G1 X0 Y0 F9000"]
    checked("\n".join(lines) + "\n", *rnd.sample(names, rnd.randrange(1, 4)))


def test_objects_do_not_depend_on_how_text_is_cut():
    text = ("EXCLUDE_OBJECT NAME=b\n" + BLOCKS).encode()
    for chunk in (1, 7, 100):
        assert ends(run(text, chunk=chunk)) == ends(run(text))


def skipped(body: str, after: str, machine: str = "unbounded") -> Outcome:
    """A line of filament, a cancelled object, and what follows on it."""
    text = f"M486 P0\nM302 P1\nM83\nG1 X10 Z1 E1 F6000\nM486 S0\n{body}\nM486 S-1\n{after}\n"
    out = run(text, machine)
    assert out.errors == []
    return out


@pytest.mark.parametrize(
    ("body", "after", "wanted"),
    [
        # Lifts take place where the head is, and it comes down only where it prints.
        ("G1 X50 Y50 E1", "G1 Z3\nG1 X80\nG1 Z1", [(10, 0, 3), (80, 50, 3), (80, 50, 1)]),
        ("G1 X50\nG1 Z3", "G1 X80\nG1 Z1", [(10, 0, 3), (80, 0, 3), (80, 0, 1)]),
        ("G1 X50\nG1 Z0", "G1 X80", [(80, 0, 1), (80, 0, 0)]),
        ("G1 X50\nG1 Z3", "G1 Z1\nG1 X60 E1", [(10, 0, 3), (50, 0, 3), (50, 0, 1), (60, 0, 1)]),
        # Without a travel in the file there is one to where the next line begins.
        ("G1 X50 Y50 E1", "G1 X80 E1", [(50, 50, 1), (80, 50, 1)]),
        ("G1 X50 Z2 E1", "G1 X80 E1", [(10, 0, 2), (50, 0, 2), (80, 0, 2)]),
        ("G1 X50 Z0.5", "G1 X80 E1", [(50, 0, 1), (50, 0, 0.5), (80, 0, 0.5)]),
        ("G1 X50", "G1 E1", [(50, 0, 1), (50, 0, 1)]),
        # A distance counts from where the program is.
        ("G91\nG1 X40", "G1 X10", [(60, 0, 1)]),
        ("G1 X50", "G53\nG91\nG1 Y5 E1", [(50, 0, 1), (50, 5, 1)]),
        ("G60 S0\nG1 X50\nG60 S1", "G1 X80\nG61 S1 X", [(80, 0, 1), (50, 0, 1)]),
        # Homing, and axes whose place is set, count from where the machine is.
        ("G1 X50 Y50", "G28 X\nG1 X5", [(5, 50, 1)]),
        ("G1 X50\nG92 X0", "G1 X5", [(55, 0, 1)]),
        # Nothing is left to do.
        ("G1 X50 E1\nG1 X10 E1", "G1 X20 E1", [(20, 0, 1)]),
    ],
)
def test_travel_after_a_cancelled_object(
    body: str, after: str, wanted: list[tuple[float, float, float]]
):
    out = skipped(body, after)
    assert [end[:3] for end in ends(out)[1:]] == wanted
    laid = [m for m in out.moves[1:] if m.end_mm[3] > m.start_mm[3]]
    assert sum(m.end_mm[3] - m.start_mm[3] for m in laid) == pytest.approx(after.count("E1"))
    assert all(m.end_mm[:3] == out.moves[-1].end_mm[:3] for m in laid)


def test_arcs_are_skipped_and_begin_where_they_would():
    out = skipped("G2 X30 Y0 I10 J0 E2", "G3 X50 I10 J0 E2")
    first, *arc = out.moves[1:]
    assert first.end_mm[:4] == (30, 0, 1, 1)
    assert arc[0].start_mm[:4] == (30, 0, 1, 1)
    assert arc[-1].end_mm[:4] == pytest.approx((50, 0, 1, 3))
    assert all((x - 40) ** 2 + y**2 == pytest.approx(100) for x, y in (m.end_mm[:2] for m in arc))
    travels = skipped("G1 X30", "G3 X50 I10 J0").moves[1:]
    assert travels[0].start_mm[:2] == (10, 0)
    assert travels[-1].end_mm[:2] == pytest.approx((50, 0))


OUTSIDE = """\
M302 P1
M83
G1 X10 Y10 Z1 F6000
EXCLUDE_OBJECT NAME=far
EXCLUDE_OBJECT_START NAME=far
G1 X-30 Y400
G2 X-10 Y400 I10 J0 E2
G1 Y-5 E1
EXCLUDE_OBJECT_END NAME=far
"""


@pytest.mark.parametrize(
    ("then", "ends", "error"),
    [
        ("G1 X20 Y20 Z1\nG1 X30 E1\n", [(20, 20), (30, 20)], None),
        ("G1 Z2\nG1 X20 Y20\n", [(10, 10), (20, 20)], None),
        ("G1 X20 Y20 E1\n", [], ("x", -10)),
        ("G1 Y50\n", [], ("x", -10)),
        ("G1 X20\n", [], ("y", -5)),
        ("G1 X20 Y-8\n", [], ("y", -8)),
    ],
)
def test_moves_of_a_cancelled_object_may_be_out_of_range(then: str, ends: Any, error: Any):
    """Only the machine must not leave its range, on the way from there neither."""
    out = run(OUTSIDE + then, "i3")
    assert [move.end_mm[:2] for move in out.moves][1:] == ends
    assert [(e[1], e[2], e[3]) for e in out.errors] == (
        [(Fault.OUT_OF_RANGE, *error)] if error else []
    )


def test_live_objects_stay_within_the_range():
    out = run(OUTSIDE.replace("EXCLUDE_OBJECT NAME=far\n", ""), "i3")
    assert {e[1] for e in out.errors} == {Fault.OUT_OF_RANGE}
    clamped = run(OUTSIDE, "i3", clamp=True)
    assert clamped.errors == []


def test_hops_of_firmware_retraction_are_those_of_the_program():
    hop = "M207 S1 F1800 Z2\n"
    out = run(
        f"{hop}M486 P0\nM83\nG1 X10 Z1 E1 F6000\nM486 S0\nG10\nG1 X30\nM486 S-1\n"
        "G1 X50\nG11\nG1 X60 E1\n",
        "unbounded",
    )
    assert ends(out)[1:] == [
        (10, 0, 1, 0),
        (10, 0, 3, 0),
        (50, 0, 3, 0),
        (50, 0, 1, 0),
        (50, 0, 1, 1),
        (60, 0, 1, 2),
    ]


def test_commands_without_motion_act_in_cancelled_object():
    out = skipped("M106 S99\nG4 P500\nM104 S200\nG1 X50 F1200\nT0\nM204 P500", "G1 X80 E1")
    assert [c for c in out.commands if c != "M302 P1"] == [
        "M106 S99",
        "M104 S200",
        "T0",
        "M204 P500",
    ]
    assert out.statistics["dwell_s"] == pytest.approx(0.5)
    assert out.moves[-1].speed_cap == pytest.approx(20)


def test_each_extruder_has_a_retraction_of_its_own():
    out = run(
        "M486 P0\nM83\nG1 X10 E1 F6000\nG1 E-2\nM486 S0\nT1\nG1 E-3\nT0\nG1 E2\nG1 X30 E1\n"
        "M486 S-1\nG1 X50\nG1 X60 E1\nT1\nG1 E3\nG1 X70 E1\n",
        "dual-extruder",
        clamp=True,
    )
    assert out.errors == []
    filament = [(m.extruder, round(m.end_mm[3] - m.start_mm[3], 6)) for m in out.moves]
    assert [f for f in filament if f[1]] == [(0, 1), (0, -2), (0, 2), (0, 1), (1, 1)]


def test_an_object_is_cancelled_and_restored_in_the_midst_of_it():
    job = Job(spec("unbounded"), False)
    job.results.keep_moves(True)

    def reads(text: str) -> list[tuple[float, ...]]:
        job.feed(text.encode())
        assert job.advance() == JobStatus.NEED_INPUT
        job.flush()
        return [tuple(round(v, 6) for v in m.end_mm[:4]) for m in job.results.take_moves()]

    assert reads("M486 T2\nM83\nM486 S1\nG1 X10 E1 F6000\n") == [(10, 0, 0, 1)]
    job.objects.cancel(1)
    assert reads("G1 X20 E1\nG1 Y20 E1\n") == []
    assert job.program_position[:2] == [10, 0]
    job.objects.cancel(1, False)
    assert reads("G1 X30 E1\n") == [(20, 20, 0, 1), (30, 20, 0, 2)]
    assert [job.objects.of_line(n) for n in (1, 2, 3, 4, 9)] == [-1, -1, 1, 1, 1]
    job.program.restart(2)  # lines that are read again come in order again
    assert job.objects.of_line(9) == -1
    assert reads("M83\nM486 S0\nG1 X31\n") == [(31, 20, 0, 2)]
    assert [job.objects.of_line(n) for n in (2, 3, 9)] == [-1, 0, 0]
    with pytest.raises(IndexError):
        job.objects.cancel(-1)


def test_a_cancelled_object_needs_no_warm_filament():
    text = "M486 P0\nM486 S0\nG1 X10 E1 F6000\nG10\nG11\nM486 S-1\nG1 X20\n"
    job = Job(spec("i3"), False)
    job.filament.cold = True
    job.feed(text.encode())
    job.finish()
    assert job.advance() == JobStatus.END


A = ObjectAction


@pytest.mark.parametrize(
    ("line", "wanted"),
    [
        ("M486 T12", [(A.COUNT, 12, "")]),
        ("M486 S3", [(A.BEGIN, 3, "")]),
        ("M486 S-1", [(A.END, -1, "")]),
        ("M486 S0 Abox", [(A.BEGIN, 0, ""), (A.NAME, -1, "box")]),
        ('M486 A"a \'b\' (2); c" S4', [(A.BEGIN, 4, ""), (A.NAME, -1, "a 'b' (2); c")]),
        ("M486 AWürfel 1 *2", [(A.NAME, -1, "Würfel 1 *2")]),
        ("M486 P1 P2 U3 C", [(A.CANCEL, 1, ""), (A.CANCEL, 2, ""), (A.RESTORE, 3, ""),
                             (A.CANCEL_CURRENT, -1, "")]),
        ("M486 P1.5", [(A.CANCEL, 10_000, "")]),
        ("M486 P", []),
        ("EXCLUDE_OBJECT NAME=a_b", [(A.CANCEL, -1, "a_b")]),
        ("EXCLUDE_OBJECT NAME=a b RESET=1", [(A.RESTORE, -1, "a b")]),
        ("EXCLUDE_OBJECT RESET=1", [(A.RESTORE_ALL, -1, "")]),
        ("EXCLUDE_OBJECT RESET=0 CURRENT=1", [(A.CANCEL_CURRENT, -1, "")]),
        ("EXCLUDE_OBJECT", []),
        ("EXCLUDE_OBJECT_START NAME='a b=c'", [(A.BEGIN, -1, "a b=c")]),
        ("EXCLUDE_OBJECT_START", []),
        ("EXCLUDE_OBJECT_END NAME=a", [(A.END, -1, "a")]),
        ("EXCLUDE_OBJECT_DEFINE CENTER=1,2 NAME=ü POLYGON=[[1, 2], [3, 4]]", [(A.DEFINE, -1, "ü")]),
    ],
)  # fmt: skip
def test_object_orders_of_commands(line: str, wanted: list[tuple[ObjectAction, int, str]]):
    code, _, text = line.partition(" ")
    assert object_orders(code, text) == wanted


def test_labels_are_kept_as_they_are_written():
    job = Job(spec("i3"), False)
    job.feed(
        b"M486 S0\nM486 A\xff\n" + b'M486 S1 A"Part (1); left" ; the first\n'
        b"N7 exclude_object_define name=Bob's CENTER=1,2 POLYGON=[[1, 2], [3, 4]] ; it's\n"
        b"G1 X1 M486 S2\nEXCLUDE_OBJECT_END ;\n"
    )
    job.finish()
    assert job.advance() == JobStatus.END
    assert job.objects.all == [
        ("?", False, "", ""),
        ("Part (1); left", False, "", ""),
        ("Bob's", False, "1,2", "[[1, 2], [3, 4]]"),
    ]


def test_no_file_fills_the_memory_with_labels():
    job = Job(spec("i3"), False)
    outline = "9" * 60_000
    for i in range(200):
        job.feed(f"EXCLUDE_OBJECT_DEFINE NAME={'x' * 5000}{i} POLYGON={outline}\n".encode())
        job.feed(f"EXCLUDE_OBJECT_DEFINE NAME={i} POLYGON={outline}\n".encode())
        assert job.advance() == JobStatus.NEED_INPUT
    job.feed(b"M486 T9999999\nM486 S123456789\nG1 X1 F600\nM486 P99999\n")
    assert job.advance() == JobStatus.NEED_INPUT
    assert len(job.objects.all) == 10_000
    assert sum(len(o[0]) + len(o[3]) for o in job.objects.all) < 4.3e6


def test_the_numbers_of_names_are_their_order_in_the_file():
    job = Job(spec("i3"), False)
    job.feed(b"M486 P1\n" + b"".join(b"EXCLUDE_OBJECT_DEFINE NAME=%c\n" % c for c in b"abcb"))
    job.finish()
    assert job.advance() == JobStatus.END
    assert [o[:2] for o in job.objects.all] == [("a", False), ("b", True), ("c", False)]
    assert (job.objects.find("B"), job.objects.find("d")) == ([1], [])


def test_axes_that_push_filament_are_skipped_like_extruders(tmp_path: Path):
    (tmp_path / "m.toml").write_text(machine_without_tools())
    machine = load(str(tmp_path / "m.toml")).core_spec()
    out = run(
        "M486 P0\nM82\nG92 X0 Y0 Z0 U0\nG1 X10 U5 F6000\nM486 S0\nG1 U3\nG1 X50\nG1 U5\nG1 X60 U8\n"
        "G2 X70 I5 J0 U9\nG1 U7\nM486 S-1\nG1 X80\nG1 U9\nG1 X90 U10\n",
        machine,
    )
    assert out.errors == []
    assert [(m.end_mm[0], m.end_mm[4]) for m in out.moves] == [
        (10, 5), (10, 3), (80, 3), (80, 5), (90, 6)
    ]  # fmt: skip
