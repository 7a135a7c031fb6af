"""`passo estimate`: as long as the print, without its steps."""

from __future__ import annotations

import json

import pytest
from tests.support.print_result import printed

from passo import Machine, config
from passo.cli.main import main
from passo.config.load import shipped_text
from passo.errors import PassoError


def test_an_estimate_agrees_with_the_print(capsys, unpacked):
    result = printed(capsys, unpacked("demo"))
    assert main(["estimate", unpacked("demo"), "--json"]) == 0
    estimate = json.loads(capsys.readouterr().out)
    assert estimate["moving_s"] == pytest.approx(result["move_time_s"], rel=1e-9)
    assert estimate["dwell_s"] == 10.0
    assert estimate["heating_s"] == pytest.approx(result["heat_time_s"], abs=1.5)
    parts = estimate["moving_s"] + estimate["heating_s"] + estimate["dwell_s"]
    assert estimate["total_s"] == pytest.approx(parts)
    assert estimate["filament_mm"] == result["filament_mm"]
    assert estimate["layers"] == len(estimate["layers_s"]) == result["layers"] == 15
    unheated = pytest.approx(estimate["moving_s"] + estimate["dwell_s"])
    assert sum(estimate["layers_s"]) + estimate["before_layers_s"] == unheated
    assert sum(estimate["features_s"].values()) == unheated


HEATING = {
    "both heaters at the same time": "M104 S200\nM190 S60\nM109 S200\nG1 X9 F3000\n",
    "one after the other": "M190 S60\nM109 S200\nG1 X9 F3000\n",
    "warm again after a pause that cools": "M109 S200\nM104 S0\nG4 S120\nM109 S210\n",
    "a target that moves delay": "M109 S190\nG1 X100 F600\nM104 S220\nG1 X9\nM116\n",
    "nothing to wait for": "M104 S200\nG1 X9 F3000\nM109 S0\nM190 S20\n",
}


@pytest.mark.parametrize("machine", ["i3", "mk3s", "corexy"])
@pytest.mark.parametrize("text", HEATING.values(), ids=HEATING)
def test_an_estimate_heats_as_long_as_the_print(capsys, tmp_path, text, machine):
    path = tmp_path / "heat.gcode"
    path.write_text(f"G28\n{text}")
    result = printed(capsys, str(path), "--machine", machine)
    estimate = Machine.load(machine).estimate(path)
    assert estimate.heating_s == pytest.approx(result["heat_time_s"], rel=0.015, abs=1.0)
    assert estimate.total_s == pytest.approx(result["print_time_s"], rel=0.015, abs=1.0)
    assert (result["heat_time_s"] > 20) is ("M109 S0" not in text)


def test_an_estimate_names_a_target_out_of_a_heaters_power(tmp_path):
    path = tmp_path / "hot.gcode"
    path.write_text("G28\nM190 S119\nG1 X9 F3000\n")
    weak = shipped_text("i3").replace("full_power_rise_c = 110.0", "full_power_rise_c = 60.0")
    estimate = Machine(config.load_text(weak)).estimate(path)
    assert estimate.warnings == [
        f"{path}: heater bed does not reach 119 °C with the figures of its simulated table, so"
        " heating_s is too short. Correct these figures, or the target."
    ]


def test_estimates_of_several_files_at_once(capsys, tmp_path):
    good, bad, last = (tmp_path / name for name in ("a.gcode", "b.gcode", "c.gcode"))
    good.write_text("G28\nG1 X10 F3000\n")
    bad.write_text("G28\nG1 X999 F3000\n")
    last.write_text("G28\nM190 S50\n")
    paths = [str(path) for path in (good, bad, last, tmp_path / "missing")]
    assert main(["estimate", "--json", *paths]) == 4
    out, err = capsys.readouterr()
    rows = json.loads(out)
    assert [row["file"] for row in rows] == paths
    assert [row["moving_s"] > 0 for row in rows] == [True, False, False, False]
    assert [row["heating_s"] > 60 for row in rows] == [False, False, True, False]
    assert [len(row["errors"]) for row in rows] == [0, 1, 0, 1]
    assert "X 999.000 mm is beyond the limit" in rows[1]["errors"][0]
    assert err.splitlines() == [rows[1]["errors"][0], rows[3]["errors"][0]]
    assert main(["estimate", *paths[:2], paths[2]]) == 4
    assert capsys.readouterr().out.count("\n\nfile  ") == 1
    assert main(["estimate", "--json", paths[0], paths[2]]) == 0
    assert len(json.loads(capsys.readouterr().out)) == 2
    assert main(["estimate", "--json", *paths, "--machine", "nothing"]) == 3
    rows = json.loads(capsys.readouterr().out)
    assert ["no machine called" in row["errors"][0] for row in rows] == [True] * 4


@pytest.mark.parametrize(
    ("text", "cold"),
    [
        ("G28\nM302 P0\nG1 X9 E2 F300\n", 3),
        ("G28\nM104 S100\nG1 X9 E2 F300\n", 3),
        ("G28\nM104 S200\nG1 X9 E2 F300\n", 3),  # it does not wait until the hotend is warm
        ("G28\nM104 S200\nG4 S300\nG1 X9 E2 F300\n", 0),
        ("G28\nM109 S200\nG1 X9 E2 F300\nM104 S0\nG4 S600\nG1 E5\n", 6),
        ("G28\nM302 P1\nG1 X9 E2 F300\n", 0),
        ("G28\nM302 S150\nM109 S160\nG1 X9 E2 F300\n", 0),
        ("G28\nM302 S210\nM109 S200\nG1 X9 E2 F300\n", 4),
        ("G28\nG1 X9 F300\n", 0),
        ("G1 X9 F300\n", 1),
        ("G28\nM112\n", 2),
    ],
)
def test_an_estimate_ends_at_the_line_of_the_print(tmp_path, text, cold):
    path = tmp_path / "cold.gcode"
    path.write_text(text)
    machine, lines = Machine.load("i3"), []
    for run in (machine.estimate, machine.print):
        try:
            run(path)
            lines.append(0)
        except PassoError as error:
            lines.append(error.problems[0].line)
    assert lines == [cold, cold]


def test_estimate_and_print_count_the_same_layers(capsys, tmp_path):
    path = tmp_path / "layers.gcode"
    layer = ";LAYER_CHANGE\nG1 Z{} F600\nG1 X{} F3000\n"
    path.write_text("G28\nG1 X5 Z1 F3000\n" + layer.format(2, 50) + layer.format(3, 9))
    estimate = Machine.load("i3").estimate(path)
    assert estimate.layers == len(estimate.layers_s) == printed(capsys, str(path))["layers"] == 2
    assert min(estimate.layers_s) > 0 < estimate.before_layers_s
