"""The distance of the nozzle from the bed in the first layer of a print."""

import pytest
from tests.support.bed_path import BedPath
from tests.support.scenario import Scenario
from tests.support.two_boards import two_boards

from passo.config.load import load_text, shipped_text
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print

TILTED = "\n[simulated.bed]\ntilt_mm = [0.3, -0.2]\ndome_mm = 0.1\n"


def machine(name, *changes, more=""):
    text = shipped_text(name)
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return load_text(text + more)


def square(low, high, z=0.2):
    """Travels at Z 5, goes down, and prints a square; a second layer is higher."""
    return [
        "G28",
        f"G1 X{low} Y{low} Z5 F6000",
        f"G1 Z{z} F300",
        f"G1 X{high} Y{low} E1 F3000",
        f"G1 X{high} Y{high} E2",
        f"G1 X{low} Y{high} E3",
        f"G1 X{low} Y{low} E4",
        "G1 Z1",
        f"G1 X{high} Y{high} E6",
    ]


def printed(machine, lines, tmp_path):
    path = tmp_path / "a.gcode"
    path.write_text("\n".join(lines))
    job = Print(machine, Policy(checked=False))
    return job.run(path), job


@pytest.mark.parametrize(
    ("of", "low", "high"),
    [
        (
            machine(
                "i3-probe",
                ("noise_mm = 0.002", ""),
                ('position = 0.0\npin = "^Z_MIN"\nfast = 5.0\nslow = 1.0', "probe = true"),
            ),
            *(40, 180),
        ),
        (machine("corexy", more=TILTED), 40, 180),
        (machine("delta-probe", ("noise_mm = 0.01", "tilt_mm = [0.3, 0.1]")), -35, 40),
        (two_boards(base="ramps-fd"), 40, 180),
    ],
    ids=["probe_homes_z", "corexy", "delta_with_wrong_geometry", "two_boards"],
)
def test_first_layer_is_that_of_the_served_printer(of, low, high, tmp_path):
    lines = square(low, high)
    layer = printed(of, lines, tmp_path)[0].first_layer
    with Scenario(of) as s:
        s.host.ok("M302 S0")
        for line in lines[:3]:
            s.host.ok(line, 60)
        s.host.ok("M400", 60)
        path = BedPath(s)
        for line in lines[3:7]:
            s.host.ok(line, 60)
        s.host.ok("M400", 60)
        heights = path.heights(below_mm=2.0, every=7)
    assert layer.lowest_mm == pytest.approx(heights.min(), abs=0.006)
    assert layer.highest_mm == pytest.approx(heights.max(), abs=0.006)


def test_first_layer_below_a_crooked_gantry(tmp_path):
    # The second motor of Z, at X 280, stands 0.6 mm too high; the first one is at X -30.
    layer = printed(machine("i3-two-z"), square(40, 180), tmp_path)[0].first_layer
    assert layer.lowest_mm == pytest.approx(0.2 - 0.15 + 0.6 * 70 / 310, abs=0.003)
    assert layer.highest_mm == pytest.approx(0.2 - 0.15 + 0.6 * 210 / 310, abs=0.003)
    assert layer.lowest_at_mm[0] == pytest.approx(40, abs=0.3)
    assert layer.highest_at_mm[0] == pytest.approx(180, abs=0.3)


def test_first_layer_after_homing_again(tmp_path):
    lines = square(40, 180)
    again = ["G28", "G1 X10 Y10 Z5 F6000", *lines]
    first, second = (printed(machine("i3"), of, tmp_path)[0].first_layer for of in (lines, again))
    assert second.lowest_mm == second.highest_mm == pytest.approx(0.2, abs=1e-9)
    assert first.mean_mm == pytest.approx(second.mean_mm, abs=1e-9)


def test_cells_are_where_the_first_layer_is(tmp_path):
    result, job = printed(machine("i3", more=TILTED), square(40, 180), tmp_path)
    rows = job.first_layer.cells
    known = {(i, j) for j, row in enumerate(rows) for i, mm in enumerate(row) if mm is not None}
    x0, y0, x1, y1 = job.first_layer.area_mm
    n = len(rows)
    low, high = (int((at - x0) / (x1 - x0) * n) for at in (40, 180))
    front, back = (int((at - y0) / (y1 - y0) * n) for at in (40, 180))
    xs, ys = range(low, high + 1), range(front, back + 1)
    edges = {(i, j) for i in xs for j in (front, back)} | {(i, j) for i in (low, high) for j in ys}
    assert known == edges
    # The bed rises to the right: the nozzle is nearer to it there.
    assert rows[front][low] > rows[front][high]
    assert result.first_layer.lowest_mm < rows[front][high] < result.first_layer.mean_mm


@pytest.mark.parametrize("name", ["i3", "laser"])
def test_program_that_extrudes_nothing_has_no_first_layer(name, tmp_path):
    result, _ = printed(machine(name), ["G28", "G1 X10 Y10 Z0.2 F3000", "G1 X60"], tmp_path)
    assert result.first_layer is None
