"""`passo report`: what its pictures show."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from tests.learn.pages import Page, report

from passo import config
from passo.cli.main import main
from passo.learn import series, toolpath

PRINTED = """G28
M83
G1 Z0.2 F3000
G1 X60 Y40 E2 F1800
G1 X60 Y80 E2
G1 E-1
G1 Z0.6
G1 X20
G1 Z0.4
G1 E1
G1 X60 Y40 E2 F4800
"""


@pytest.fixture
def page(tmp_path):
    """A function that reports a program."""

    def of(text: str, *words: str, status: int = 0) -> Page:
        path = tmp_path / "a.gcode"
        path.write_text(text)
        return report(path, *words, status=status)

    return of


def test_a_move_of_half_a_second_is_a_trapezoid(page):
    shown = page("G28\nG1 X50 F6000\n")
    assert shown.data["end_s"] == pytest.approx(0.5 + 1 / 30)
    (speed,) = shown.curves("Speed")
    expected = [(0, 0), (1 / 30, 100), (0.5, 100), (0.5 + 1 / 30, 0)]
    assert speed.corners == [pytest.approx(corner, abs=1e-6) for corner in expected]
    (acceleration,) = shown.curves("Acceleration")
    levels = [v for _, v in acceleration.corners]
    assert levels == pytest.approx([3000, 3000, 0, 0, -3000, -3000], abs=0.1)
    x, y, z, e = shown.curves("Step")
    assert [v for _, v in x.corners] == pytest.approx([0, 8000, 8000, 0])
    assert [curve.highest for curve in (y, z, e)] == [0, 0, 0]


def test_first_layer_has_the_distance_of_each_cell_of_the_bed(page):
    layer = page("M140 S60\nM104 S200\n" + PRINTED, "--machine", "i3-probe").data["first_layer"]
    heights = [mm for row in layer["cells"] for mm in row if mm is not None]
    assert len(heights) > 4
    mean = float(layer["text"].split("on average ")[1].split()[0])
    assert layer["mean_mm"] == pytest.approx(mean, abs=5e-4)
    assert min(heights) < mean < max(heights)


def test_every_chart_has_a_title_and_a_unit(page):
    shown = page("M140 S60\nM104 S200\n" + PRINTED)
    assert [(chart["title"], chart["unit"]) for chart in shown.data["charts"]] == [
        ("Speed along the path", "mm/s"),
        ("Acceleration along the path; braking is negative", "mm/s²"),
        ("Temperature and target of each heater", "°C"),
        ("Power of each heater", "% of full power"),
        ("Step rate of each motor", "steps/s"),
    ]
    assert shown.data["path"]["prints"] is True
    assert [layer[1] for layer in shown.data["path"]["layers"][1:]] == [0.2, 0.4]
    assert {limit["name"] for limit in shown.data["limits"]} >= {"feedrate", "print acceleration"}


def test_a_page_is_one_file_that_needs_no_network(page):
    text = page(PRINTED).text.replace("http://www.w3.org/2000/svg", "")  # the name of SVG
    assert not re.search(r"https?:|//[a-z]|\bsrc=|<link|@import|url\(", text)
    assert text.count("<script") == 2


def test_names_cannot_break_the_page(tmp_path):
    path = tmp_path / "<b>&amp;'\".gcode"
    path.write_text("G28\nG1 X5\n;TYPE:</script><i>\nG1 X9\n;TYPE:b\nG1 X5\n")
    shown = report(path)
    assert shown.title == f"{path.name} on i3"
    assert "<b>" not in shown.text
    assert "</script><i>" in {feature["name"] for feature in shown.data["features"]}


@pytest.mark.parametrize(
    "machine", ["i3", "corexy", "delta", "rotary-delta", "scara", "dual-extruder"]
)
def test_rates_are_those_of_every_motor(tmp_path, machine):
    model = config.load(machine)
    x, y = ((model.axes[a].min_mm + model.axes[a].max_mm) / 2 for a in "xy")
    program = f"""G28
G1 X{x} Y{y + 25} Z20 F2400
G1 X{x + 30} Y{y + 38} E2
G1 X{x - 20} Y{y + 45} Z22 E4
G1 E-20
"""
    if machine == "dual-extruder":
        program += f"T1\nG92 E0\nG1 X{x} Y{y} E30\n"
    path, steps = tmp_path / "a.gcode", tmp_path / "a.npz"
    path.write_text(program)
    shown = report(path, "--machine", machine)
    rates = dict(zip(shown.names("Step"), shown.curves("Step"), strict=True))
    words = ["--machine", machine, "--ideal", "--output", str(steps)]
    assert main(["steps", str(path), *words]) == 0
    executed = np.load(steps)
    assert set(rates) == {k.removesuffix("_ideal_s") for k in executed if k.endswith("_ideal_s")}
    for name, rate in rates.items():
        times, ways = executed[f"{name}_ideal_s"], executed[f"{name}_dir"]
        same = ways[5:] == ways[:-5]  # five steps on, in one direction
        fastest = np.max(5 / (times[5:] - times[:-5])[same])
        assert 0.98 * fastest <= rate.highest <= 1.02 * fastest
        # The area below the curve is the steps that were made.
        t, v = (np.array(column) for column in zip(*rate.corners, strict=True))
        assert np.sum((v[1:] + v[:-1]) / 2 * np.diff(t)) == pytest.approx(
            len(times), rel=0.01, abs=2
        )


def test_a_further_axis_has_its_rate(page, tmp_path):
    machine = tmp_path / "m.toml"
    machine.write_text(
        f"""{config.shipped_text("i3")}
[axes.u]
max_mm = 60
speed_mm_s = 20
accel_mm_s2 = 200
[steppers.u]
steps_per_mm = 100
socket = "E1"
"""
    )
    shown = page("G28\nG1 U30 F600\n", "--machine", str(machine))
    rates = dict(zip(shown.names("Step"), shown.curves("Step"), strict=True))
    highest = {name: round(rate.highest, 3) for name, rate in rates.items()}
    assert highest == {"x": 0, "y": 0, "z": 0, "e": 0, "u": 1000}


def test_speeds_are_in_mm_where_the_path_is_measured_in_steps(page, tmp_path):
    law = 'junction = "deviation"'
    machine = tmp_path / "m.toml"
    machine.write_text(config.shipped_text("i3").replace(law, 'junction = "cornering_distance"'))
    program = "G28\nM204 T1000\nG1 X30 Y40 F3000\nG1 X60 Y80 E1\nG1 E-4 F600\n"
    shown = page(program, "--machine", str(machine))
    (speed,), (acceleration,) = shown.curves("Speed"), shown.curves("Acceleration")
    assert speed.highest == pytest.approx(50)
    assert speed.corners[-2][1] == pytest.approx(10)  # of the retraction
    lowest = min(v for _, v in acceleration.corners)
    assert lowest == pytest.approx(-5000, rel=1e-4)  # of the retraction, too
    assert acceleration.corners[0][1] == pytest.approx(1000, rel=1e-4)


def test_the_machine_is_at_standstill_while_it_waits(page):
    shown = page("G28\nG4 S500\nG1 Z200 F12\nG4 S300\nG1 Z100 F60\n")
    (speed,) = shown.curves("Speed")
    t, v = zip(*speed.corners, strict=True)
    assert shown.data["end_s"] == pytest.approx(1900, abs=0.1)
    at = [100.0, 499.9, 501.0, 1500.2, 1650.0, 1801.0]
    assert np.interp(at, t, v) == pytest.approx([0, 0, 0.2, 0, 0, 1], abs=1e-3)


def test_heaters_show_temperature_target_and_power(page):
    """A hotend that is on for ten seconds only, before a move of forty; the bed is never on."""
    shown = page("M104 S200\nG1 X100 F600\nM104 S0\nG1 X0 F300\nG1 X100\n")
    assert shown.names("Temperature") == ["hotend", "hotend target", "bed"]
    celsius, target, bed = shown.curves("Temperature")
    power, _ = shown.curves("Power")
    seconds, values = zip(*celsius.corners, strict=True)
    assert len(seconds) > 50
    assert values[0] == pytest.approx(25, abs=1)
    hottest = values.index(max(values))
    assert 10 < seconds[hottest] < 20  # it gets warmer still for a while
    assert max(values) > values[0] + 5
    t, v = zip(*target.corners, strict=True)
    assert np.interp([5, 9.9, 10.3, 40], t, v) == pytest.approx([200, 200, 0, 0])
    t, v = zip(*power.corners, strict=True)
    assert np.interp([5, 9.9, 11, 40], t, v) == pytest.approx([100, 100, 0, 0])
    assert bed.highest == pytest.approx(25, abs=1)


def test_a_file_that_only_heats_has_no_pictures_of_moves(page):
    shown = page("M140 S40\nM109 S60\nG4 S5\n")
    assert shown.charts() == ["Temperature", "Power"]
    assert shown.data["path"] is None
    assert shown.data["end_s"] > 5
    assert shown.result()["Moves"] == "0"


def test_table_splits_the_print_time(page):
    told = page("G28\nM109 S60\nG4 S3670\nG1 X100 F600\n").result()
    assert told["Waiting"] == "1 h 01 min 10 s"
    parts = [float(told[name].removesuffix(" s")) for name in ("Moving", "Heating")]
    hours, minutes, seconds = re.fullmatch(
        r"(\d) h (\d\d) min (\d\d) s", told["Print time"]
    ).groups()
    total = 3600 * int(hours) + 60 * int(minutes) + int(seconds)
    assert sum(parts) + 3670 == pytest.approx(total, abs=1)


def test_report_and_estimate_count_the_same_layers(page, tmp_path, capsys):
    shown = page(PRINTED)
    assert main(["estimate", str(tmp_path / "a.gcode"), "--assume-ready"]) == 0
    assert re.search(r"moves, layers +9, 2\n", capsys.readouterr().out)
    assert shown.result()["Layers"] == "2"
    # Heights of the layers, and when their moves begin and end; none of the lift to 0.6 mm.
    layers = shown.data["path"]["layers"]
    assert [layer[1] for layer in layers[1:]] == [0.2, 0.4]
    assert layers[1][2] < layers[1][3] <= layers[2][2] < layers[2][3]
    assert layers[2][3] == pytest.approx(shown.data["end_s"], abs=1e-3)


@pytest.mark.parametrize(
    ("text", "status", "said"),
    [
        ("G28\nG1 X50 F6000\nG1 X999\n", 4, ":3: X 999.000 mm is beyond the limit"),
        ("G28\nG1 X50 F6000\nM112\n", 5, ":3: "),
    ],
)
def test_a_print_that_stops_has_a_page_with_the_reason(page, capsys, text, status, said):
    shown = page(text, status=status)
    (alert,) = shown.data["problems"]
    assert said in alert
    assert shown.result() == {}
    assert said in capsys.readouterr().err
    (speed,) = shown.curves("Speed")  # what was planned until then
    assert speed.highest == pytest.approx(100)


@pytest.mark.parametrize("text", [None, "", "; nothing\n", "Dear printer,\n"])
def test_a_file_without_a_command_has_no_page(tmp_path, text):
    path, page = tmp_path / "a.gcode", tmp_path / "r.html"
    if text is not None:
        path.write_text(text)
    assert main(["report", str(path), "--output", str(page)]) == 4
    assert not page.exists()


def test_the_page_of_a_long_file_is_bounded(tmp_path, monkeypatch):
    for room, name, most in [
        (series, "MAX_CORNERS", 500),
        (series, "MAX_COLUMNS", 512),
        (toolpath, "MAX_LINES", 1000),
    ]:
        monkeypatch.setattr(room, name, most)
    sizes = list[int]()
    for turns in (40, 400):
        path = tmp_path / f"{turns}.gcode"
        turn = "G1 X60 Y20 E1\nG1 X60 Y60 E1\nG1 X20 Y60 E1\nG1 X20 Y20 E1\n"
        path.write_text("G28\nM83\nG1 X20 Y20 Z.2 F6000\n" + turns * turn)
        shown = report(path)
        sizes.append(len(json.dumps(shown.data)))
    assert shown.curves("Speed")[0].highest == pytest.approx(100, rel=1e-3)
    assert shown.data["finest_s"] == 2
    assert sizes[1] < 1.5 * sizes[0]
