"""The flow of filament (M221): each extruder's own, retractions, what a line has yet to say."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.gcode.driver import spec
from tests.oracles import flow as oracle

from passo._core import Job, JobStatus


def job_of(text, machine=None, *, with_steps=False):
    """A job that has read a whole program; events `M221 E F` are carried out as F of extruder E."""
    job = Job(machine or spec("unbounded"), with_steps)
    job.results.keep_moves(True)
    job.feed(text.encode())
    job.finish()
    while (status := job.advance()) is not JobStatus.END:
        assert status is JobStatus.EVENT
        event = job.event
        if event[2] == 221:
            extruder, factor = event[5].split()
            job.filament.set_flow(int(extruder[1:]), float(factor[1:]))
    job.flush()
    return job


def lengths(moves):
    return [m.end_mm[3] - m.start_mm[3] for m in moves]


def test_each_extruder_has_its_own_flow():
    two = spec("unbounded") | {
        "extruders": [spec("i3")["extruders"][0], spec("i3")["extruders"][0] | {"name": "e1"}],
        "tools": [{"extruder": 0, "offset": [0.0] * 3}, {"extruder": 1, "offset": [0.0] * 3}],
    }
    del two["filters"]
    text = "M83\nM221 E1 F0.5\nG1 X1 E2\nT1\nG1 X2 E2\nT0\nG1 X3 E2\nM221 E0 F2\nG1 X4 E2\n"
    job = job_of(text, two)
    assert lengths(job.results.take_moves()) == [2, 1, 2, 4]
    assert job.filament.flows == [2, 0.5]


@pytest.mark.parametrize("bad", [0.0, -0.5, float("inf"), float("nan")])
def test_invalid_flow_is_refused(bad):
    job = job_of("")
    with pytest.raises(ValueError, match="above 0"):
        job.filament.set_flow(0, bad)
    with pytest.raises(IndexError):
        job.filament.set_flow(1, 1.0)


@pytest.mark.parametrize(
    ("text", "made"),
    [
        # What was drawn back by 2 mm comes back by 2 mm; what goes beyond it is scaled.
        ("M83\nG1 E-2\nM221 E0 F.5\nG1 X5\nG1 E2\nG1 X9 E4", [-2, 0, 2, 2]),
        ("M83\nG1 E-2\nM221 E0 F.5\nG1 X5\nG1 E3\nG1 X9 E4", [-2, 0, 2.5, 2]),
        ("M82\nG1 E-2\nM221 E0 F.5\nG1 X5\nG1 E0\nG1 X9 E4", [-2, 0, 2, 2]),
        ("M83\nM221 E0 F.5\nG1 E-2\nM221 E0 F2\nG1 E1\nG1 E1\nG1 E1", [-1, 0.5, 0.5, 2]),
        # Drawn back by two flows, in parts, and while it moves.
        ("M83\nG1 E-1\nM221 E0 F.5\nG1 X5 E-1\nM221 E0 F2\nG1 E2\nG1 E1", [-1, -0.5, 1.5, 2]),
        # No retraction, but an unloading.
        ("M83\nG1 E-30\nM221 E0 F.5\nG1 E30", [-30, 15]),
        # Lengths of filament, whatever the flow is.
        ("M207 S4\nM83\nG10\nM221 E0 F.5\nG11\nG1 E2", [-4, 4, 1]),
    ],
)
def test_a_retraction_is_given_back_whatever_the_flow_is_then(text, made):
    assert lengths(job_of(text).results.take_moves()) == pytest.approx(made, abs=1e-12)


def test_flow_scales_volumetric_extrusion():
    area = 3.141592653589793 * (1.75 / 2) ** 2
    text = f"M83\nM200 D1.75\nG1 E{-2 * area}\nM221 E0 F.5\nG1 E{2 * area}\nG1 E{area}"
    assert lengths(job_of(text).results.take_moves()) == pytest.approx([-2, 2, 0.5], abs=1e-12)


def test_event_before_removed_filament_keeps_its_position():
    """Twice 15 mm is an unloading, to which nothing is owed: the way back is no move any more."""
    job = Job(spec("unbounded"))
    job.results.keep_moves(True)
    job.feed(b"M83\nG1 X10 F3000\nG1 E-15\nG1 X20\nM7\nG1 E15\nG1 X30\nM8\nG1 X40\n")
    while job.advance() is JobStatus.EVENT:
        job.outputs.mark(job.event[2], 1)
    job.flush()
    job.results.take_moves()
    job.filament.scale_flow_from(0.0, 0, 2.0)
    job.flush()
    moves = job.results.take_moves()
    assert [(m.end_mm[0], m.end_mm[3]) for m in moves] == [
        (10, 0),
        (10, -30),
        (20, -30),
        (30, -30),
        (40, -30),
    ]
    places = [(round(moves[i].start_ticks), number, 1) for i, number in ((3, 7), (4, 8))]
    marks = []
    while job.outputs.next_mark is not None:
        marks.append(job.outputs.next_mark)
        job.outputs.pop_mark()
    assert marks == places


word = st.one_of(
    st.integers(-30, 60).map(lambda n: f"E{n / 10}"),
    st.tuples(st.integers(0, 40), st.integers(-10, 60)).map(lambda p: f"X{p[0]} E{p[1] / 10}"),
    st.integers(0, 40).map(lambda n: f"X{n}"),
)
programs = st.lists(word, min_size=1, max_size=12)


@given(programs, st.floats(0, 1), st.sampled_from([0.5, 0.95, 1.3]), programs)
@settings(max_examples=80, deadline=None)
def test_flow_change_at_any_clock_of_any_program(words, where, factor, behind):
    """Retractions before, around and behind the change; and lines that are read after it."""
    text = "M83\nG1 F1200\n" + "".join(f"G1 {w}\n" for w in words)
    job = Job(spec("unbounded"), True)
    job.results.keep_moves(True)
    job.feed(text.encode())
    assert job.advance() is JobStatus.NEED_INPUT
    job.flush()
    moves = job.results.take_moves()
    program = job.program_position
    cut = job.filament.scale_flow_from(job.clock * where, 0, factor)
    assert job.program_position == program  # the program does not notice
    job.feed("".join(f"G1 {w}\n" for w in behind).encode())
    assert job.advance() is JobStatus.NEED_INPUT
    job.flush()
    left = oracle.behind_the_way_to_brake(moves, cut)
    whole = lengths(moves)
    before = whole[: len(whole) - len(left)]
    if left and abs(left[0]) < abs(whole[len(before)]) - 1e-9:
        before.append(whole[len(before)] - left[0])
    owed = 0.0
    for mm in before:
        owed = max(0.0, owed - mm)
        owed = owed if owed <= 20 else 0.0
    later = [float(w.partition("E")[2] or 0) for w in behind]
    wanted = sum(before) + oracle.fed(left + later, factor, owed)
    assert job.machine_position[3] == pytest.approx(wanted, abs=1e-6)
    (e,) = [s for s in job.motors.statistics() if s["name"] == "e"]
    assert e["net"] == e["expected_net"] == e["count"]
    assert abs(e["count"] - wanted * e["steps_per_unit"]) <= 0.5 + 1e-3


@pytest.mark.parametrize("share", [0.0, 0.3, 0.8])
def test_flow_change_within_an_arc(share):
    """A full circle of 10 mm of filament, of which the plan has a part."""
    job = Job(spec("unbounded"), True)
    job.feed(b"M83\nG1 F1200\nG2 I50 E10\nG1 X10 E1\n")
    job.finish()
    while job.machine_position[3] <= 10 * share and not job.program.at_boundary:
        job.advance(0, 0) if share == 0.0 else job.advance(job.clock + 1)
    planned = job.machine_position[3]
    cut = job.filament.scale_flow_from(float("inf"), 0, 0.5)
    assert cut == job.clock
    while job.advance() is not JobStatus.END:
        pass
    job.flush()
    assert planned < 10
    assert job.machine_position[3] == pytest.approx(planned + (11 - planned) / 2, abs=1e-9)


def test_flow_changes_suspended_moves_too():
    job = job_of("M83\nG1 X100 E10 F600\nG1 X0 E10\n", with_steps=True)
    job.stops.hold_from(1.0 * 16e6)
    job.stops.suspend()
    stop = job.stops.position[3]
    job.filament.scale_flow_from(job.clock, 0, 0.5)
    job.stops.resume()
    job.flush()
    assert job.filament.flows == [0.5]
    assert job.machine_position[3] == pytest.approx(stop + (20 - stop) / 2, abs=1e-9)
