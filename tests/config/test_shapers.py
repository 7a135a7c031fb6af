"""Impulses of shapers against published tables and the vibration that they leave."""

from __future__ import annotations

import pytest
from tests.oracles.filters import residual

from passo import config
from passo.config.load import shipped_text
from passo.config.notes import notes
from passo.config.shapers import SHAPER_TYPES, impulses, shaper_form
from passo.errors import ConfigError

# At 50 Hz and a damping ratio of 0.1: weights, times in ms, their mean, and what is left of the
# vibration in percent at 40, 45, 50, 55 and 60 Hz.
GOLDEN = {
    "zv": (
        (0.578286182, 0.421713818),
        (0, 10.050378),
        4.238383,
        (27.040, 13.472, 0, 13.053, 25.385),
    ),
    "mzv": (
        (0.365127888, 0.407489353, 0.227382759),
        (0, 7.537784, 15.075567),
        6.499491,
        (19.087, 8.641, 0, 6.497, 10.646),
    ),
    "zvd": (
        (0.334414908, 0.487742548, 0.177842545),
        (0, 10.050378, 20.100756),
        8.476767,
        (7.311, 1.815, 0, 1.704, 6.444),
    ),
    "ei": (
        (0.354881380, 0.452998090, 0.192120530),
        (0, 10.144803, 20.100756),
        8.457344,
        (2.439, 3.279, 5.062, 3.082, 2.145),
    ),
    "2hump_ei": (
        (0.258535476, 0.359935695, 0.272763820, 0.108765008),
        (0, 10.318112, 20.164124, 29.778526),
        12.452762,
        (5.019, 3.520, 0.051, 3.361, 4.934),
    ),
    "3hump_ei": (
        (0.220854412, 0.277211466, 0.259699689, 0.167055160, 0.075179272),
        (0, 10.810038, 20.561020, 30.117980, 39.658542),
        16.349221,
        (0.225, 3.692, 4.920, 3.078, 0.731),
    ),
}


@pytest.mark.parametrize("kind", SHAPER_TYPES)
def test_impulses_are_those_of_the_tables(kind):
    weights, times_ms, mean_ms, left = GOLDEN[kind]
    found = impulses(kind, 50.0, 0.1)
    assert [a for a, _ in found] == pytest.approx(weights, abs=1e-9)
    assert [t * 1e3 for _, t in found] == pytest.approx(times_ms, abs=1e-6)
    assert sum(a * t for a, t in found) * 1e3 == pytest.approx(mean_ms, abs=1e-6)
    assert sum(a for a, _ in found) == 1
    for frequency, percent in zip((40, 45, 50, 55, 60), left, strict=True):
        assert residual(found, frequency, 0.1) * 100 == pytest.approx(percent, abs=2e-3)


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.1, 0.2])
@pytest.mark.parametrize("tolerance", [0.02, 0.05, 0.1, 0.2])
def test_ei_leaves_its_tolerance_at_its_frequency(tolerance, damping):
    """And at most that within the width of the shaper, as Singhose's extra-insensitive shapers."""
    form = f"ei(v_tol={tolerance})"
    found = impulses(form, 50.0, damping)
    assert sum(a for a, _ in found) == 1
    assert residual(found, 50.0, damping) == pytest.approx(tolerance, rel=0.08)
    near = [residual(found, 50.0 * (1 + i / 100), damping) for i in range(-5, 6)]
    assert max(near) == pytest.approx(tolerance, rel=0.08)
    if damping == 0:
        weights = [(1 + tolerance) / 4, (1 - tolerance) / 2, (1 + tolerance) / 4]
        assert [a for a, _ in found] == pytest.approx(weights, abs=7e-3)


@pytest.mark.parametrize(
    ("text", "form"),
    [
        ("EI(v_tol=0.02)", "ei(v_tol=0.02)"),
        ("ei ( v_tol = .1 )", "ei(v_tol=0.1)"),
        ("ei(0.02)", "ei(v_tol=0.02)"),
        ("ei(v_tol=0.05)", "ei"),
        ("MZV", "mzv"),
        ("ei(v_tol=0.3)", None),
        ("ei(v_tol=0)", None),
        ("ei(v_tol=-0.1)", None),
        ("zv(v_tol=0.02)", None),
        ("mzv(n=4,t=1.0)", None),
    ],
)
def test_forms_of_types_are_shortened(text, form):
    if form is not None:
        assert shaper_form(text) == form
        return
    with pytest.raises(ValueError, match=r"at most 0\.2"):
        shaper_form(text)


def test_machine_file_has_the_tolerance_of_ei():
    table = '\n[shaping.x]\ntype = "ei(v_tol=0.02)"\nfrequency_hz = 40.0\n'
    machine = config.load_text(f"{shipped_text('i3')}{table}")
    assert machine.shaping["x"].type == "ei(v_tol=0.02)"


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        ("advance_knees = [[1.0, 0.02]]", "expected an advance_s above 0"),
        (
            "advance_s = 0.05\nadvance_knees = [[1.0, 0.06]]",
            "a speed above 0 mm/s, and at most",
        ),
        ("advance_s = 0.05\nadvance_knees = [[2.0, 0.03], [1.0, 0.02]]", "a speed above 2 mm/s"),
    ],
)
def test_knees_that_are_not_a_falling_curve_are_refused(keys, reason):
    text = shipped_text("i3").replace("[extruders.e]\n", f"[extruders.e]\n{keys}\n")
    with pytest.raises(ConfigError) as refused:
        config.load_text(text)
    assert reason in str(refused.value)


@pytest.mark.parametrize("kind", SHAPER_TYPES)
def test_weights_and_times_are_the_same_on_every_computer(kind):
    for weight, seconds in impulses(kind, 37.3, 0.07):
        assert weight * 2**40 == round(weight * 2**40)
        assert seconds == round(seconds * 1e9) / 1e9


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        ('type = "ei"\nfrequency_hz = 40.0\ndamping = 0.5', "at most 0.4 for the type ei"),
        ("frequency_hz = 5.0", "15"),
        ('type = "square"\nfrequency_hz = 40.0', "zvd"),
        ('type = "ei(v_tol=0.21)"\nfrequency_hz = 40.0', "at most 0.2"),
        ('type = "ei(v_tol=0.0)"\nfrequency_hz = 40.0', "at most 0.2"),
    ],
)
def test_machine_file_with_an_impossible_shaper_is_refused(tmp_path, table, reason):
    path = tmp_path / "m.toml"
    path.write_text(f"{shipped_text('i3')}\n[shaping.x]\n{table}\n")
    with pytest.raises(ConfigError) as refused:
        config.load(str(path))
    assert reason in str(refused.value)


def test_low_limit_of_jerk_is_refused_and_a_good_one_noted(tmp_path):
    """A right angle is cut by √2 (s·w/8 + A·w²/48)."""
    path = tmp_path / "m.toml"
    text = shipped_text("i3")
    path.write_text(text.replace("[limits]", "[limits]\njerk_mm_s3 = 2e4"))
    with pytest.raises(ConfigError) as refused:
        config.load(str(path))
    assert "at least 40000 mm/s³" in str(refused.value)
    path.write_text(text.replace("[limits]", "[limits]\njerk_mm_s3 = 1e5"))
    box_s, accel = 0.06, 3000.0
    cut_mm = [2**0.5 * (s * box_s / 8 + accel * box_s**2 / 48) for s in (0.0, 10.0)]
    noted = [note for note in notes(config.load(str(path))) if "jerk" in note]
    assert f"averages all positions over {box_s * 1e3:.1f} ms" in noted[0]
    assert all(f"{mm:.3f} mm" in noted[0] for mm in cut_mm)
