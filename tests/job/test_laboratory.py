"""The laboratory: its ruler against closed forms, and its choice of the best setting."""

from itertools import pairwise
from math import dist, sqrt

import pytest

from passo import config
from passo.config.motion import Shaping
from passo.config.shapers import impulses
from passo.config.simulated_motion import SimulatedMass
from passo.job.batch.laboratory import Laboratory, Setting, Trial, run_laboratory, settings_for
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


def measured(machine, folder, text=L_SHAPE):
    path = folder / "corner.gcode"
    path.write_text(text)
    job = Print(machine)
    watch = QualityWatch(machine, job, 0)
    job.watch_steps(watch)
    job.run(path)
    return watch


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
def laboratory(tmp_path_factory):
    path = tmp_path_factory.mktemp("lab") / "corner.gcode"
    path.write_text("M900 K0.5\nM593 F90\n" + L_SHAPE)
    return run_laboratory(_I3, path)


def test_laboratory_measures_less_ringing_with_shapers(laboratory):
    trials = {trial.name: trial for trial in laboratory.trials}
    plain, best = trials["none"], laboratory.trials[laboratory.best]
    assert trials["mzv"].quality.ringing_rms_um < 0.2 * plain.quality.ringing_rms_um
    assert trials["mzv"].off_tune_rms_um < 0.25 * plain.off_tune_rms_um
    assert trials["jerk limit"].quality.ringing_rms_um < 0.6 * plain.quality.ringing_rms_um
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


def trial(name, time_s, ringing, rounding, width):
    quality = Quality(4, 100, ringing, 2 * ringing, rounding, rounding, 1, 1, width, 0)
    return Trial(name, time_s, quality, ringing, 1, 1)


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
    found = Laboratory("f", "m", weight, trials)
    assert found.trials[found.best].name == best
    if best != "fast":
        assert "3.0% longer" in found.reason()


def test_laboratory_warns_where_the_head_leaves_the_path(tmp_path):
    """A head on a very soft belt, in a fast zigzag."""
    masses = {n: SimulatedMass(frequency_hz=6.0) for n in "xyz"}
    simulated = _I3.simulated.model_copy(update={"masses": masses})
    path = tmp_path / "zigzag.gcode"
    rows = [f"G1 X{20 + 30 * (i % 2)} Y{20 + 5 * i} E1.2\n" for i in range(20)]
    path.write_text("M83\nG1 X20 Y20 F12000\n" + "".join(rows))
    found = run_laboratory(_I3.model_copy(update={"simulated": simulated}), path)
    lost = [line.split(":")[0] for line in found.warnings if "did not follow the file" in line]
    assert "none" in lost
    assert "3hump_ei" not in lost
