"""What `passo report` shows of motion filters around the fastest corner."""

from __future__ import annotations

import pytest
from tests.learn.pages import report
from tests.oracles import filters as oracle

from passo import config
from passo.config.jerk import box_s
from passo.config.load import shipped_text
from passo.config.shapers import impulses
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print
from passo.job.batch.step_trace import trace_steps

HZ = 16e6
CORNER = "G28\nM302 S0\nM83\nG1 X20 Y20 F6000\nG1 X60 E1.6\nG1 Y60 E1.6\nG1 X58 Y20 E1.6 F1800\n"
MZV = '[shaping.x]\ntype = "mzv"\nfrequency_hz = 50.0\n'
EI = '[shaping.y]\ntype = "ei"\nfrequency_hz = 38.0\n'
GAPS = "[backlash]\nx_mm = 0.08\ny_mm = 0.05\nsmooth_mm = 3.0\n"
AMPLITUDES = (0.365127888, 0.407489353, 0.227382759)  # of mzv with a damping of 0.1


def text_of(filters="", advance=""):
    text = shipped_text("i3").replace("[extruders.e]\n", f"[extruders.e]\n{advance}\n")
    if "jerk" in filters:
        return text.replace("[limits]\n", f"[limits]\n{filters}\n")
    return text + filters


@pytest.fixture
def printed(tmp_path):
    """A function that prints a program, and returns its job."""

    def of(program, machine):
        path = tmp_path / "a.gcode"
        path.write_text(program)
        job = Print(config.load_text(machine), Policy())
        job.job.results.keep_moves(True)
        job.job.results.keep_corner()
        job.run(path)
        return job.job

    return of


def samples(parts):
    """Times in s, positions and speeds at nine points of each part."""
    for start, took, q, v, a, j in parts:
        for i in range(9):
            u = took * i / 8
            yield start + u, q + u * (v + u * (a / 2 + u * j / 6)), v + u * (a + u * j / 2)


def test_acceleration_after_mzv_has_its_amplitudes(printed):
    job = printed(CORNER, text_of(MZV))
    (line, x, y, _), planned, law = (
        job.results.corner,
        job.results.corner_law(0, False),
        job.results.corner_law(0, True),
    )
    assert (line, x, y) == (6, 60, 20)
    levels = [a for _, _, _, _, a, _ in planned]
    assert levels == pytest.approx([0, -3000, 0], abs=60)  # it slows down before the corner
    hardest = min(levels)
    rising = [sum(AMPLITUDES[:i]) for i in range(4)]
    expected = [hardest * share for share in (*rising, *(1 - share for share in rising[1:]))]
    assert [a for _, _, _, _, a, _ in law] == pytest.approx(expected, abs=1e-3)


def test_filament_is_as_fast_as_the_advance_asks(printed):
    """The example of the golden values: 10 mm at 1000 mm/s² and 50 mm/s."""
    advance = "advance_s = 0.05\nadvance_smooth_s = 0.04"
    program = "G28\nM302 S0\nM204 P1000\nG1 X10 E0.4 F3000\n"
    job = printed(program, text_of(advance=advance))
    planned, law = ([v for _, _, v in samples(job.results.corner_law(3, f))] for f in (False, True))
    assert max(planned) == pytest.approx(2.0)
    assert max(law) == pytest.approx(3.36, abs=2e-3)
    hardest = max(a for _, _, _, _, a, _ in job.results.corner_law(3, True))
    assert hardest == pytest.approx(140, abs=1e-3)


def test_jerk_stays_within_its_limit(printed):
    job = printed(CORNER, text_of("jerk_mm_s3 = 100000.0"))
    hardest = max(abs(part[4]) for part in job.results.corner_law(0, False))
    jerk = max(abs(j) for *_, j in job.results.corner_law(0, True))
    assert jerk == pytest.approx(hardest / box_s(3000, 1e5))
    assert jerk <= 1e5


@pytest.mark.parametrize(("advance", "shaped"), [(0.05, "true"), (0.05, "false"), (0.0, "true")])
def test_laws_are_those_of_the_oracle(printed, advance, shaped):
    own = f"advance_s = {advance}\nadvance_smooth_s = 0.04\nshaped = {shaped}"
    job = printed(CORNER, text_of(MZV + EI, own))
    moves, delay = job.results.take_moves(), round(job.filters.delay_s * HZ)
    shapers = [impulses("mzv", 50.0, 0.1), impulses("ei", 38.0, 0.1)]
    for slot, shaper in enumerate(shapers):
        planned = oracle.Planned(moves, slot)
        law = oracle.shaped(planned, shaper, delay)
        for filtered, wanted in ((False, lambda t, p=planned: p(t - delay)), (True, law)):
            for s, mm, _ in samples(job.results.corner_law(slot, filtered)):
                assert mm == pytest.approx(wanted(s * HZ), abs=1e-6)
    if shaped == "false":
        filament = oracle.Planned(moves, 3, lambda m: m.advance_s)
        law = oracle.advanced(filament, 0.02, delay) if advance else lambda t: filament(t - delay)
        for s, mm, _ in samples(job.results.corner_law(3, True)):
            assert mm == pytest.approx(law(s * HZ), abs=1e-6)


def test_steps_are_made_from_the_laws(printed, tmp_path):
    """Each executed step is where the law is between two counts, also while a gap is taken up."""
    machine = text_of(MZV + EI + GAPS, "advance_s = 0.05\nadvance_smooth_s = 0.04")
    job, model = printed(CORNER, machine), config.load_text(machine)
    trace = trace_steps(model, tmp_path / "a.gcode", Policy())
    for slot, name in ((0, "x"), (1, "y"), (3, "e")):
        parts, count, seen = job.results.corner_law(slot, True), 0, 0
        for tick, turn in zip(trace.ticks[name], trace.directions[name], strict=True):
            middle, count = count + turn / 2, count + turn
            for start, took, q, v, a, j in parts:
                u = tick / HZ - start
                if 0 <= u < took:
                    steps = q + u * (v + u * (a / 2 + u * j / 6))
                    steps *= model.steppers[name].steps_per_mm
                    assert steps == pytest.approx(middle, abs=0.02)
                    seen += 1
        assert seen > 50


def test_corner_is_the_fastest_of_printed_lines(printed):
    """Not the slow one before it, nor one of travel moves; filters that come later do not count."""
    program = (
        "G28\nM302 S0\nM83\nG1 X20 Y20 F3000\nG1 X40 E1\nG1 Y40 E1\nG1 X20 F9000\nG1 Y20\n"
        "G1 X60 E2 F4800\nG1 Y60 E2\nG1 X20 F9000\nM593 F0\nG1 X60 E1\nG1 Y20 E1\n"
    )
    job = printed(program, text_of(MZV))
    assert job.results.corner[:3] == (10, 60, 20)
    assert len(job.results.corner_law(0, True)) > len(job.results.corner_law(0, False))
    job = printed(program.replace(" E", " ;"), text_of(MZV))
    assert job.results.corner[0] == 8
    job = printed("G28\nG1 X20 F3000\n", text_of(MZV))
    assert job.results.corner[:3] == (2, 0, 0)


def test_page_shows_the_peaks_of_plan_and_filters(tmp_path):
    path, machine = tmp_path / "a.gcode", tmp_path / "m.toml"
    path.write_text(CORNER)
    machine.write_text(text_of(MZV, "advance_s = 0.05\nadvance_smooth_s = 0.04"))
    shown = report(path, "--machine", str(machine)).data["filters"]
    assert shown["title"] == "What the filters do: the fastest corner, line 6, X60.0 Y20.0"
    names = [[curve["name"] for curve in chart["curves"]] for chart in shown["charts"]]
    peaks = [[name.partition(", peak ") for name in chart] for chart in names]
    axes = ["X planned", "X executed", "Y planned", "Y executed"]
    assert [[name for name, _, _ in chart] for chart in peaks] == [
        axes,
        axes,
        ["planned", "executed"],
    ]
    assert peaks[0][0][2] == "100"
    before_ms, after_ms = shown["columns_ms"]
    assert before_ms < 0 < after_ms
    assert after_ms - before_ms == pytest.approx(1e3 * shown["took_s"])


def test_page_without_filters_does_not_show_them(tmp_path):
    path = tmp_path / "a.gcode"
    path.write_text(CORNER)
    assert report(path).data["filters"] is None
