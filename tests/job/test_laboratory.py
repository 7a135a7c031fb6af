"""The laboratory: its ruler against closed forms, and its choice of the best setting."""

import os
from itertools import pairwise
from math import dist, sqrt

import pytest

from passo import config
from passo.config.motion import Backlash, Shaping
from passo.config.shapers import impulses
from passo.config.simulated_motion import SimulatedMass
from passo.errors import InputError
from passo.job.batch.comparison import Comparison, Trial
from passo.job.batch.laboratory import run_laboratory
from passo.job.batch.motion_setting import Setting, settings_for
from passo.job.batch.policy import Policy
from passo.job.batch.quality_watch import Quality, QualityWatch
from passo.job.batch.simulated_print import Print

_I3 = config.load("i3")
_ACCEL, _CORNER = 3000.0, 5.0  # mm/s², mm/s
L_SHAPE = """G92 E0
G1 X20 Y20 F6000
G1 X80 E2.4 F6000
G1 Y80 E4.8
G1 X60 Y60 E5.9
"""


def stiff(**changes):
    """An i3 of fine steps that is nearly rigid, with one speed at every right corner."""
    axes = {n: _I3.axes[n].model_copy(update={"jerk_mm_s": _CORNER}) for n in "xy"}
    steppers = {
        n: _I3.steppers[n].model_copy(update={"steps_per_mm": steps})
        for n, steps in {"x": 320.0, "y": 320.0, "e": 3000.0}.items()
    }
    masses = {n: SimulatedMass(frequency_hz=400.0, damping=0.5) for n in "xyz"}
    return _I3.model_copy(
        update={
            "axes": {**_I3.axes, **axes},
            "steppers": {**_I3.steppers, **steppers},
            "limits": _I3.limits.model_copy(update={"junction": "jerk"}),
            "simulated": _I3.simulated.model_copy(update={"masses": masses}),
            **changes,
        }
    )


def advanced(advance_s, smooth_s):
    update = {"advance_s": advance_s, "advance_smooth_s": smooth_s}
    return {"e": _I3.extruders["e"].model_copy(update=update)}


def measured(machine, folder, text=L_SHAPE, policy=None):
    path = folder / "corner.gcode"
    path.write_text(text)
    job = Print(machine, policy)
    watch = QualityWatch(machine, job, 0)
    job.watch_steps(watch)
    return watch.measurement(job.run(path))


@pytest.mark.parametrize("kind", ["mzv", "ei", "3hump_ei"])
def test_rounding_of_a_corner_is_that_of_its_closed_form(kind, tmp_path):
    """√2 Σ a (s + A t / 2) t over the impulses at t after the mean, exact for a symmetric shaper
    (Klipper's documentation of resonance compensation)."""
    shaper = impulses(kind, 50.0, 0.0)
    mean = sum(a * t for a, t in shaper)
    later = [(a, t - mean) for a, t in shaper if t > mean]
    wanted = sqrt(2) * sum(a * (_CORNER + _ACCEL * t / 2) * t for a, t in later)
    shaping = {n: Shaping(type=kind, frequency_hz=50.0, damping=0.0) for n in "xy"}
    found = measured(stiff(shaping=shaping), tmp_path, L_SHAPE.rsplit("G1", 1)[0]).quality
    assert found.corners == 1
    assert found.rounding_um == pytest.approx(1000 * wanted, rel=0.02)
    assert found.lost == 0


def test_rigid_machine_without_filters_follows_its_file(tmp_path):
    found = measured(stiff(), tmp_path).quality
    assert found.corners == 2
    assert found.ringing_peak_um < 5
    assert found.rounding_um < 5
    assert found.printed_mm == pytest.approx(120 + sqrt(800), rel=0.02)


def width_error_mm(machine, folder):
    """The integral of the error of the width around the first corner, in mm of line."""
    samples = measured(machine, folder).corner.samples
    assert samples[0].s < -0.05
    return sum(
        abs(b.width - 1) * dist(a.head_mm, b.head_mm) for a, b in pairwise(samples) if b.width > 0
    )


def test_advance_makes_lines_even_around_a_corner(tmp_path):
    """100 to 5 to 100 mm/s through a nozzle of 0.05 s: 3.72 mm without advance."""
    assert width_error_mm(stiff(), tmp_path) == pytest.approx(3.6, abs=0.2)
    assert width_error_mm(stiff(extruders=advanced(0.05, 0.02)), tmp_path) <= 0.13
    assert 0.3 < width_error_mm(stiff(extruders=advanced(0.05, 0.04)), tmp_path) < 0.5


def test_lines_are_most_even_with_the_default_law(tmp_path):
    """Unshaped and smoothed over 0.02 s, on a machine that vibrates, with mzv."""
    text = "G92 E0\nG91\nG1 X20 Y20 F6000\n"
    text += "".join(
        f"G1 {'XY'[i % 2]}{(9 - i) * (-1) ** (i // 2) * 3} E{(9 - i) * 0.12:.3f}\n"
        for i in range(8)
    )
    default = Setting("mzv", advance=True).on(_I3)
    errors = {}
    for name, update in {
        "default": {},
        "shaped": {"shaped": True},
        "slow": {"advance_smooth_s": 0.04},
        "both": {"shaped": True, "advance_smooth_s": 0.04},
    }.items():
        extruder = default.extruders["e"].model_copy(update=update)
        machine = default.model_copy(update={"extruders": {"e": extruder}})
        errors[name] = measured(machine, tmp_path, text).quality.width_error
    assert errors["default"] < 0.9 * min(errors["shaped"], errors["slow"])
    assert max(errors["shaped"], errors["slow"]) < errors["both"]


def test_each_setting_has_one_filter_and_the_values_of_the_machine():
    shaped = _I3.model_copy(update={"shaping": {"x": Shaping(type="ei", frequency_hz=41.0)}})
    names = [setting.name for setting in settings_for(shaped)]
    assert names[:3] == ["none", "zv", "mzv"]
    assert names[-2:] == ["junction cornering distance", "junction jerk"]
    assert not Setting().on(shaped).shaping
    machine = Setting("zvd", advance=True).on(shaped)
    assert [(s.type, s.frequency_hz) for s in machine.shaping.values()] == [
        ("zvd", 41.0),
        ("zvd", 35.0),
    ]
    assert machine.extruders["e"].advance_s == 0.05


@pytest.fixture(scope="module")
def corner(tmp_path_factory):
    path = tmp_path_factory.mktemp("lab") / "corner.gcode"
    path.write_text("M900 K0.5\nM593 F90\n" + L_SHAPE)
    return path


@pytest.fixture(scope="module")
def laboratory(corner):
    return run_laboratory(_I3, corner)


def test_laboratory_measures_less_ringing_with_shapers(laboratory):
    trials = {trial.name: trial for trial in laboratory.trials}
    plain, best = trials["none"], laboratory.trials[laboratory.best]
    assert trials["mzv"].quality.ringing_rms_um < 0.2 * plain.quality.ringing_rms_um
    assert trials["mzv"].off_tune_rms_um < 0.25 * plain.off_tune_rms_um
    s_curve = trials["S-curve (jerk limit)"]
    assert s_curve.quality.ringing_rms_um < 0.6 * plain.quality.ringing_rms_um
    assert trials["3hump_ei"].quality.rounding_um > 3 * trials["mzv"].quality.rounding_um
    assert trials["advance"].quality.width_error < 0.6 * plain.quality.width_error
    assert trials["advance"].quality.ringing_rms_um == pytest.approx(
        plain.quality.ringing_rms_um, rel=1e-3
    )
    assert "advance" in best.name
    assert f"{best.name} is best" in laboratory.reason()


def test_laboratory_shows_the_same_corner_of_every_setting(laboratory):
    corners = [trial.corner for trial in laboratory.trials]
    assert len({corner.at_mm for corner in corners}) == 1
    assert {corner.line for corner in corners} == {7}


def trial(name, time_s, ringing, rounding, width, lost=0.0):
    quality = Quality(4, 100, ringing, 2 * ringing, rounding, rounding, 1, 1, width, lost)
    return Trial(name, time_s, quality, ringing, lost, 1, 1)


@pytest.mark.parametrize(
    ("weight", "best"),
    [("ringing", "still"), ("corners", "sharp"), ("lines", "even"), ("time", "fast")],
)
def test_best_setting_follows_the_weight(weight, best):
    trials = [
        trial("fast", 100, 40, 60, 0.1),
        trial("still", 103, 2, 60, 0.1),
        trial("sharp", 103, 40, 3, 0.1),
        trial("even", 103, 40, 60, 0.005),
    ]
    if weight == "time":
        trials = [trials[0], trial("still", 130, 2, 60, 0.1), trial("even", 130, 40, 60, 0.005)]
    found = Comparison("f", "m", weight, trials)
    assert found.trials[found.best].name == best
    if best != "fast":
        assert "3.0% longer" in found.reason()


def test_trial_that_left_the_path_is_not_compared():
    lost = trial("lost", 50, 1, 1, 0.01, lost=0.02)
    whole = [trial("none", 100, 40, 60, 0.1), trial("mzv", 101, 20, 60, 0.1)]
    found = Comparison("f", "m", "balance", [whole[0], lost, whole[1]])
    assert found.trials[found.best].name == "mzv"
    assert found.scores()[::2] == Comparison("f", "m", "balance", whole).scores()
    assert [row["score"] is None for row in found.as_dict()["trials"]] == [False, True, False]


def test_file_without_printed_lines_is_refused(tmp_path):
    path = tmp_path / "travel.gcode"
    path.write_text("G28\nG1 X50 Y50 F6000\nG1 X80\n")
    with pytest.raises(InputError, match="prints no line"):
        run_laboratory(_I3, path)


def test_pipe_is_refused_as_it_is_printed_often(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    writes = os.open(path, os.O_RDWR)  # so that opening it does not wait
    try:
        with pytest.raises(InputError, match="can be read only once"):
            run_laboratory(_I3, path)
    finally:
        os.close(writes)


def test_file_without_corners_is_warned_of(tmp_path):
    path = tmp_path / "line.gcode"
    path.write_text("G92 E0\nG1 X80 E2.4 F6000\n")
    found = run_laboratory(_I3, path)
    assert found.warnings == [
        "no sharp corner between printed lines: the rounding of corners is unknown"
    ]


def test_place_is_known_while_a_soft_belt_swings_far(tmp_path):
    """A head of 6 Hz in a fast zigzag of lines 5 mm apart, which is off them by half of that."""
    masses = {n: SimulatedMass(frequency_hz=6.0) for n in "xyz"}
    simulated = _I3.simulated.model_copy(update={"masses": masses})
    rows = [f"G1 X{20 + 30 * (i % 2)} Y{20 + 5 * i} E1.2\n" for i in range(20)]
    text = "M83\nG1 X20 Y20 F12000\n" + "".join(rows)
    found = measured(_I3.model_copy(update={"simulated": simulated}), tmp_path, text).quality
    assert found.corners == 18
    assert found.lost == 0
    assert 2000 < found.largest_off_path_um < 5000


@pytest.mark.parametrize(
    ("name", "changes", "begin"),
    [
        ("i3-probe", {}, "G28\nG29\n"),
        ("i3", {"backlash": Backlash(x_mm=0.2, y_mm=0.1)}, "M425 X0.3\n"),
        ("delta-probe", {}, "G28\n"),
        ("delta-probe", {}, "G28\nG33\n"),
        ("corexy", {}, ""),
        ("scara", {}, ""),
        ("rotary-delta", {}, ""),
    ],
)
def test_motors_hold_the_head_on_the_plan(name, changes, begin, tmp_path):
    """Whatever the geometry of the machine, the shape of its bed and the gaps of its drives."""
    machine = config.load(name).model_copy(update=changes)
    x0, y0, x1, y1 = machine.bed_area_mm
    x, y = (x0 + x1) / 2 - 10, (y0 + y1) / 2 - 10
    corner = f"G92 E0\nG1 X{x} Y{y} Z3 F3000\nG1 X{x + 20} E0.8\nG1 Y{y + 20} E1.6\n"
    simulated = Setting("zv").on(machine)
    found = measured(simulated, tmp_path, begin + corner, Policy(motion_only=True)).quality
    assert found.corners == 1
    assert found.lost == 0
    assert 5 < found.rounding_um < 60
    assert found.off_path_um < 10


def test_homing_between_lines_leaves_the_place_known(tmp_path):
    shaped = Setting("3hump_ei", advance=True).on(_I3)
    found = measured(shaped, tmp_path, f"{L_SHAPE}G28 X\n{L_SHAPE}G28\n{L_SHAPE}").quality
    once = measured(shaped, tmp_path, L_SHAPE).quality
    assert found.corners == 3 * once.corners
    assert found.lost == 0
    assert found.rounding_um == pytest.approx(once.rounding_um, rel=0.01)


def test_processes_find_what_one_process_finds(laboratory, corner, monkeypatch):
    monkeypatch.setattr("passo.job.batch.laboratory._LONG_PRINT_S", 0.0)
    done = list[tuple[int, int]]()
    found = run_laboratory(_I3, corner, progress=lambda *each: done.append(each), workers=2)
    assert found == laboratory
    prints = 2 * len(found.trials)
    assert done == [(i + 1, prints) for i in range(prints)]
