"""The study file and its settings."""

import pytest

from passo.errors import ConfigError, InputError
from passo.study.plan import plan_study
from passo.study.settings import hypercube, settings_of
from passo.study.study_file import Latin, Study, load_study


def study(**keys):
    return Study.model_validate({"files": ["a.gcode"], "machines": ["i3"], **keys})


def planned(folder, **keys):
    (folder / "a.gcode").write_text("G1 X1\n")
    return plan_study(study(**keys), folder)


def test_settings_are_all_combinations_in_order():
    found = settings_of(study(grid={"a": [1, 2], "b": [3]}, settings=[{"c": 4}, {"c": 5, "a": 9}]))
    assert list(found) == [
        {"a": 1, "b": 3, "c": 4},
        {"a": 9, "b": 3, "c": 5},
        {"a": 2, "b": 3, "c": 4},
        {"a": 9, "b": 3, "c": 5},
    ]


def test_study_without_settings_has_the_machine_as_it_is():
    assert list(settings_of(study())) == [{}]


def test_hypercube_has_one_sample_in_each_part_of_each_range():
    keys = {
        "linear": {"min": 10.0, "max": 20.0},
        "ratio": {"min": 1.0, "max": 1024.0, "logarithmic": True},
        "kind": {"choices": ["zv", "mzv"]},
    }
    latin = Latin.model_validate({"samples": 10, "seed": 7, "keys": keys})
    samples = list(hypercube(latin))
    assert sorted(int(s["linear"]) for s in samples) == list(range(10, 20))
    assert sorted(int(s["ratio"]).bit_length() for s in samples) == list(range(1, 11))
    assert sorted(s["kind"] for s in samples) == ["mzv"] * 5 + ["zv"] * 5
    assert samples == list(hypercube(latin))
    assert samples != list(hypercube(latin.model_copy(update={"seed": 8})))


def test_whole_samples_are_integers():
    keys = {"n": {"min": 1.0, "max": 4.0, "whole": True}}
    samples = hypercube(Latin.model_validate({"samples": 5, "keys": keys}))
    assert {type(sample["n"]) for sample in samples} == {int}


def test_each_problem_of_a_study_file_has_its_line(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(
        'files = ["a.gcode"]\nmachine = ["i3"]\nwhat = "guess"\n'
        "[latin]\nsamples = 3\n[latin.keys.a]\nmin = 2\nmax = 1\n"
    )
    with pytest.raises(ConfigError) as raised:
        load_study(path)
    assert [(p.code, p.line) for p in raised.value.problems] == [
        ("config.missing-key", 1),
        ("config.unknown-key", 2),
        ("config.value", 3),
        ("config.value", 6),
    ]
    assert "min at most max" in str(raised.value.problems[3])


def test_a_key_is_set_by_its_path(tmp_path):
    setting = {
        "limits.junction_deviation_mm": 0.05,
        "shaping.x": {"type": "zv", "frequency_hz": 40},
    }
    (case,) = planned(tmp_path, settings=[setting]).cases
    (plain,) = planned(tmp_path).cases
    assert case.work is not None and case.id != plain.id
    (same,) = planned(tmp_path, grid={"limits.junction_deviation_mm": [0.02]}).cases
    assert same.id == plain.id  # 0.02 is the value of the file


def test_a_setting_that_does_not_fit_is_a_row(tmp_path):
    plan = planned(tmp_path, grid={"axes.x.accel_mm_s2": [1000.0, -1.0]})
    good, bad = plan.cases
    assert good.work is not None and bad.work is None
    assert (bad.result["status"], bad.result["code"]) == ("config", "config.value")
    assert "axes.x.accel_mm_s2" in bad.result["message"]


@pytest.mark.parametrize("key", ["axes.x.acceleration", "axes.x.min_mm.low", "tools[9].x", ""])
def test_a_key_that_fits_no_machine_ends_the_study(tmp_path, key):
    with pytest.raises(ConfigError) as raised:
        planned(tmp_path, grid={key: [1.0, 2.0]})
    assert raised.value.problems[0].code == "config.unknown-key"


def test_pattern_without_files_is_an_error(tmp_path):
    with pytest.raises(InputError) as raised:
        planned(tmp_path, files=["*.nc"])
    assert raised.value.problems[0].code == "study.no-files"


def test_key_without_values_is_an_error(tmp_path):
    with pytest.raises(InputError) as raised:
        planned(tmp_path, grid={"axes.x.accel_mm_s2": []})
    assert "grid.axes.x.accel_mm_s2" in str(raised.value)


def test_each_file_is_planned_once_in_order(tmp_path):
    for name in ("c.gcode", "b.gcode"):
        (tmp_path / name).write_text("G1 X1\n")
    plan = planned(tmp_path, files=["c.gcode", "*.gcode"])
    assert [case.file for case in plan.cases] == ["c.gcode", "a.gcode", "b.gcode"]
    b, c = plan.cases[2], plan.cases[0]
    assert b.id == c.id  # equal content
