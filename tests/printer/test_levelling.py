"""The bed is measured and corrected; the nozzle follows it, by the executed steps."""

import re

import numpy as np
import pytest
from tests.support.bed_path import BedPath
from tests.support.edited_machine import answers, at_home, edited
from tests.support.scenario import Scenario

from passo.printer.setup.simulated_world import simulated_bed

STEP = 1 / 400
NOISE = "noise_mm = 0.002"
TILT_AND_DOME = "tilt_mm = [0.4, -0.25]\ndome_mm = 0.15"
QUADRATIC = 'method = "quadratic"'
LAYER = [
    f"G1 X{x} Y{y} Z0.2 F9000"
    for j, y in enumerate(range(5, 216, 15))
    for x in ((0, 225) if j % 2 == 0 else (225, 0))
]


def machine(*changes):
    return edited("i3-probe", *changes)


def homed(*changes, **options):
    return at_home(machine(*changes), **options)


def above_the_bed(s):
    """Heights of the nozzle above the bed, mm, in a layer at Z 0.2."""
    s.host.ok("G1 X0 Y5 Z5 F6000", 60)
    s.host.ok("G1 Z0.2", 60)
    s.host.ok("M400", 60)
    path = BedPath(s)
    for line in LAYER:
        s.host.ok(line, 60)
    s.host.ok("M400", 200)
    return path.heights(below_mm=2.0)


def rms(heights):
    return float(np.sqrt(np.mean((heights - 0.2) ** 2)))


WHOLE = ("[15.0, 15.0, 215.0, 205.0]", "[0.0, 5.0, 225.0, 215.0]")
DOME = ("dome_mm = 0.15", "dome_mm = 0.4")
WAVES = [("dome_mm = 0.15", "wave_mm = 0.05"), ("[5, 5]", "[7, 7]")]  # 120 mm in X, 160 in Y


def mesh(interpolation, *changes):
    method = f'method = "mesh"\ninterpolation = "{interpolation}"'
    return [(QUADRATIC, method), WHOLE, *changes]


@pytest.mark.parametrize(
    ("changes", "line", "limit"),
    [
        ([], "G32", 0.01),
        ([(QUADRATIC, 'method = "linear"'), ("dome_mm = 0.15", "")], "G32", 0.01),
        (mesh("bilinear", DOME), "G29", 0.02),
        (mesh("bicubic", DOME), "G29", 0.012),
        (mesh("bilinear", *WAVES), "G29", 0.02),
        (mesh("bicubic", *WAVES), "G29", 0.012),
    ],
    ids=["quadratic", "linear", "dome_bilinear", "dome_bicubic", "waves_bilinear", "waves_bicubic"],
)
def test_first_layer_follows_the_bed(changes, line, limit):
    with homed((NOISE, "noise_mm = 0.005"), *changes) as s:
        s.host.ok(line, 900)
        # Homing in between changes nothing.
        s.host.ok("G28", 60)
        heights = above_the_bed(s)
        assert len(heights) > 100_000
        assert rms(heights) <= limit


def test_uncorrected_bed_shows_in_the_first_layer():
    with homed() as s:
        assert rms(above_the_bed(s)) > 0.1


def test_second_mesh_is_the_first_within_the_noise():
    sigma = 0.005
    with homed((NOISE, f"noise_mm = {sigma}"), *mesh("bicubic", ("[5, 5]", "[4, 4]"))) as s:
        found = []
        for _ in range(2):
            s.host.ok("G29", 900)
            found.append(np.array(s.printer.motion.correction.correction.mesh.heights))
        apart = found[1] - found[0]
        assert 0 < np.sqrt(np.mean(apart**2)) <= 2 * sigma


def test_heights_are_those_that_the_correction_leaves():
    with homed((NOISE, "")) as s:
        said = answers(s, "G32")
        bed = simulated_bed(s.machine).shape
        heights = [x for x in said if x.startswith("//ProbeHeight")]
        points = s.machine.levelling.points
        for n, (point, line) in enumerate(zip(points, heights, strict=True), 1):
            assert line.startswith(f"//ProbeHeight@P{n} ")
            assert float(line.split()[1]) == pytest.approx(bed.height(point.x, point.y), abs=STEP)
        assert re.match(r"RelativeCorrections Z:\S+ X:\S+ Y:\S+ XX:\S+ XY:\S+ YY:\S+$", said[9])
        before = s.printer.motion.correction.correction.fit
        again = [float(x.split()[1]) for x in answers(s, "G32") if x.startswith("//Probe")]
        assert max(map(abs, again)) < 2 * STEP
        after = s.printer.motion.correction.correction.fit
        assert after.height(100, 100) == pytest.approx(before.height(100, 100), abs=STEP)


def test_refusal_says_what_the_machine_lacks_for_a_command():
    with homed() as s:
        assert answers(s, "BED_MESH_OUTPUT")[0].startswith("echo:the bed was not measured")
        answers(s, "G32")
        for line in ("BED_MESH_OUTPUT", "M421 I0 J0 Z0.1", "G42 I0 J0"):
            assert answers(s, line)[0].startswith("echo:the correction of the bed is a surface")
        for line in ("G34", "Z_TILT_ADJUST"):
            assert answers(s, line)[0].endswith("this machine has no [levelling.motors]")
        assert answers(s, "G33")[0].endswith("this machine has no towers of a delta")


def test_dry_run_measures_only():
    with homed() as s:
        assert answers(s, "G32 D")[9].startswith("RelativeCorrections Z:")
        assert answers(s, "M937") == ["echo:No corrections of the bed are in effect"]
        answers(s, "G29 D")
        assert s.printer.motion.correction.correction is None


def test_correction_changes_z_and_moves_no_motor():
    with homed() as s:
        answers(s, "G32")
        at = s.positions()
        corrected = s.printer.rig.job.machine_position
        c = s.printer.motion.correction.expected(*corrected[:2])
        assert corrected[2] == pytest.approx(10.0 - c, abs=1e-9)
        assert s.host.ok("M114 R")[0].split()[2] == s.host.ok("M114")[0].split()[2]
        answers(s, "M420 S0")
        assert s.positions() == at
        assert s.printer.rig.job.machine_position[2] == pytest.approx(10.0, abs=1e-9)
        assert answers(s, "M420 S1") == ["echo:Bed Leveling ON", "echo:Fade Height OFF"]
        assert s.printer.rig.job.machine_position == pytest.approx(corrected, abs=1e-9)
        answers(s, "M561")
        assert answers(s, "M420 S1")[0] == "Invalid mesh."
        assert s.positions() == at


@pytest.mark.parametrize(
    "changes", [[], [(QUADRATIC, 'method = "mesh"'), ("[5, 5]", "[3, 4]")]], ids=["fit", "mesh"]
)
def test_correction_survives_a_restart_bit_for_bit(tmp_path, changes):
    state = str(tmp_path)
    with homed(*changes, state=state) as s:
        answers(s, "G29")
        answers(s, "M420 Z10")
        s.board.spoil_probe(noise_mm=0.01)
        answers(s, "G29")
        answers(s, "M851 X-25.1 Z-1.23")
        answers(s, "M500")
        stored = s.printer.motion.correction.correction
    with Scenario(machine(*changes), state=state) as s:
        found = s.printer.motion.correction
        assert found.on
        assert found.correction.fade == stored.fade
        assert found.correction.fade.end_mm == 10.0
        if stored.fit:
            assert found.correction.fit.coefficients == stored.fit.coefficients
        else:
            assert found.correction.mesh == stored.mesh
        assert s.printer.motion.prober.offset_mm == (-25.1, 5.0)
        assert s.printer.motion.prober.trigger_height_mm == 1.23
        s.host.ok("G28", 60)
        c = found.correction.height(0, 0, s.printer.rig.job.machine_position[2])
        assert s.printer.rig.job.machine_position[2] == pytest.approx(-c, abs=1e-9)
        answers(s, "M502")
        assert (found.correction, found.on) == (None, False)
        assert s.printer.motion.prober.offset_mm == (-25.0, 5.0)


def test_correction_survives_a_restart_of_the_boards():
    with homed() as s:
        answers(s, "G32")
        before = s.printer.motion.correction.correction
        s.host.send("M112")
        s.passes(1)
        s.host.ok("M999", 60)
        s.passes(1)
        assert s.printer.motion.correction.on
        assert s.printer.motion.correction.correction.fit.coefficients == before.fit.coefficients
        s.host.ok("G28", 60)
        c = before.plain(0, 0)
        assert s.printer.rig.job.machine_position[2] == pytest.approx(-c, abs=1e-9)


@pytest.mark.parametrize("line", ["G32", "G29"])
def test_failed_run_leaves_the_correction(line):
    with homed() as s:
        answers(s, "G32")
        before = s.printer.motion.correction.correction
        at = s.machine.levelling.points[3]
        x, y = at.x + 25, at.y - 5
        s.board.spoil_probe(dead_areas=[(x - 1, y - 1, x + 1, y + 1)])
        said = answers(s, line)
        assert re.search(r"^echo:Point 4 was not measured: the probe was not triggered", said[-1])
        assert s.printer.motion.correction.correction is before
        assert s.printer.motion.correction.on
        c = before.plain(x, y)
        assert s.positions()["z"] == 10.0
        assert s.printer.rig.job.machine_position[2] == pytest.approx(10 - c, abs=1e-9)


def test_low_point_follows_the_known_bed():
    with homed() as s:
        answers(s, "G32")
        c = s.printer.motion.correction.expected(215, 110)
        s.board.force_switch("probe", False)
        low = round(c - 2, 4)
        assert f"search ends at Z {low:g} mm" in answers(s, "G32 P4")[-1]


def test_paper_test_leaves_the_nozzle_above_the_point():
    with homed((NOISE, "")) as s:
        (said,) = answers(s, "G32 P5 R0.5")
        height = float(said.removeprefix("//ProbeHeight@P5 "))
        assert s.positions()["z"] == pytest.approx(height + 1.2 + 0.5, abs=2 * STEP)
        assert s.printer.motion.correction.correction is None
        assert "P is 10: expected a point from 1 to 9" in answers(s, "G32 P10")[0]


@pytest.mark.parametrize(
    ("limit", "says"),
    [
        ("max_correction_mm = 0.2", r"corrected by 0\.\d+ mm \(max_correction_mm is 0\.2 mm\)"),
        ("max_slope = 0.001", r"would rise by 0\.00\d+ mm per mm \(max_slope is 0\.001\)"),
    ],
)
def test_bed_that_is_out_of_order_is_refused(limit, says):
    with homed((QUADRATIC, f"{QUADRATIC}\n{limit}")) as s:
        assert re.search(says, answers(s, "G32")[-1])
        assert s.printer.motion.correction.correction is None


def test_mesh_is_reported_as_rows_of_numbers():
    with homed((QUADRATIC, 'method = "mesh"'), ("[5, 5]", "[3, 4]"), (NOISE, "")) as s:
        said = answers(s, "G29")
        assert said[0] == "Bilinear Leveling Grid:"
        rows = [[float(x) for x in line.split()[1:]] for line in said[2:]]
        bed = simulated_bed(s.machine).shape
        xs, ys = s.printer.levelling.bed.grid().xs, s.printer.levelling.bed.grid().ys
        assert [len(row) for row in rows] == [3] * 4
        for y, row in zip(ys, rows, strict=True):
            for x, z in zip(xs, row, strict=True):
                assert z == pytest.approx(bed.height(x, y), abs=STEP + 5e-4)
        assert answers(s, "M420 V")[:6] == said
        answers(s, "G29 W I1 J2 Z0.125")
        assert s.printer.motion.correction.correction.mesh.heights[2][1] == 0.125


def test_mesh_by_klippers_and_marlins_words():
    with homed(("[5, 5]", "[3, 3]"), (NOISE, "")) as s:
        assert "was not measured" in answers(s, "BED_MESH_OUTPUT")[0]
        answers(s, "BED_MESH_CALIBRATE")
        rows = answers(s, "BED_MESH_OUTPUT")[1:]
        heights = s.printer.motion.correction.correction.mesh.heights
        read = [[float(x) for x in row.split()] for row in rows]
        assert read == [[pytest.approx(z, abs=1e-6) for z in row] for row in heights]
        answers(s, "M421 I0 J1 Z0.25")
        answers(s, "M421 I0 J1 Q-0.05")
        assert s.printer.motion.correction.correction.mesh.heights[1][0] == pytest.approx(0.2)
        assert "I below 3, J below 3" in answers(s, "M421 I3 J1 Z0")[0]
        answers(s, "BED_MESH_CLEAR")
        assert s.printer.motion.correction.correction is None


def test_values_that_no_bed_has_are_refused():
    with homed((QUADRATIC, 'method = "mesh"'), ("[5, 5]", "[3, 3]")) as s:
        assert "'C0=nan' has no valid number" in answers(s, "SET_BED_FIT C0=nan")[0]
        assert (
            "'X0=inf' has no valid number"
            in answers(s, "SET_BED_MESH COLUMNS=3 ROWS=3 X0=inf Y0=0 X1=9 Y1=9")[0]
        )
        answers(s, "G29")
        before = s.printer.motion.correction.correction
        assert "max_correction_mm is 2 mm" in answers(s, "M421 I0 J0 Z50")[0]
        assert s.printer.motion.correction.correction is before


def test_probe_offset_has_two_signs():
    with homed() as s:
        assert answers(s, "M851") == ["  M851 X-25.0 Y5.0 Z-1.2 ; (mm)"]
        answers(s, "G1 Z10")
        answers(s, "M400")
        answers(s, "G31 Z1.5 X-20")
        assert answers(s, "M851") == ["  M851 X-20.0 Y5.0 Z-1.5 ; (mm)"]
        says = "Z probe 0: current reading 0, threshold 500, trigger height 1.500, offsets X-20.0"
        assert answers(s, "G31")[0].startswith(says)
        assert "Z is -21" in answers(s, "M851 Z-21")[0]
        assert s.printer.motion.prober.trigger_height_mm == 1.5


def test_second_nozzle_is_above_the_bed_at_its_own_place():
    tools = (
        '[steppers.e1]\nsteps_per_mm = 95.5\nsocket = "E1"\n'
        "[extruders.e1]\nspeed_mm_s = 100.0\naccel_mm_s2 = 5000.0\n"
        '[[tools]]\nextruder = "e"\n[[tools]]\nextruder = "e1"\noffset_mm = [30.0, 0.0, 0.0]\n'
    )
    with homed((NOISE, ""), ("[limits]", f"{tools}[limits]")) as s:
        s.host.ok("G29", 600)
        bed = simulated_bed(s.machine).shape

        def height(offset_mm):
            s.host.ok("M400", 60)
            at = s.positions()
            return at["z"] - bed.height(at["x"] + offset_mm, at["y"])

        for line in ("G1 X150 Y60 Z1 F9000", "T1", "G1 X60 Y150", "G1 X120"):
            s.host.ok(line, 60)
        assert height(30) == pytest.approx(1.0, abs=0.005)
        assert s.positions()["x"] == 90.0
        s.host.ok("T0", 60)
        s.host.ok("G1 X120 Y150", 60)
        assert height(0) == pytest.approx(1.0, abs=0.005)
