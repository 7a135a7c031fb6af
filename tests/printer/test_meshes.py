"""Meshes that are stored under names, of a part of the bed, and relative to a place."""

import json

import pytest
from tests.support.edited_machine import STILL, answers, at_home, edited
from tests.support.scenario import Scenario

from passo.config.exporting.settings import Sections
from passo.printer.klipper.objects import objects
from passo.printer.setup.simulated_world import simulated_bed

STEP = 1 / 400
MESH = ('"quadratic"', '"mesh"'), ("[5, 5]", "[4, 3]")


def machine(*changes):
    return edited("i3-probe", STILL, *MESH, *changes)


def homed(*changes, **options):
    return at_home(machine(*changes), **options)


def test_stored_meshes_survive_a_restart(tmp_path):
    with homed(state=str(tmp_path)) as s:
        answers(s, "M140 S60")
        assert answers(s, "BED_MESH_CALIBRATE PROFILE=pei")[-1] == "// Mesh Bed Leveling Complete"
        stored = s.printer.motion.correction.correction.mesh
        answers(s, "BED_MESH_CLEAR")
        assert s.printer.levelling.bed.status().profile == ""
    with Scenario(machine(), state=str(tmp_path)) as s:
        (said,) = answers(s, "BED_MESH_PROFILE")
        assert said.startswith("// pei: 4 × 3 points, 20")
        assert said.endswith(" C")
        assert "Mesh pei is in use" in answers(s, "BED_MESH_PROFILE LOAD=pei")[0]
        assert s.printer.motion.correction.on
        assert s.printer.motion.correction.correction.mesh == stored
        assert s.printer.levelling.bed.status().profile == "pei"
        answers(s, "BED_MESH_PROFILE REMOVE=pei")
        assert (
            "is pei: expected a name that SAVE has stored"
            in answers(s, "BED_MESH_PROFILE LOAD=pei")[0]
        )
        assert list((tmp_path / "meshes").iterdir()) == []
        assert "../x" in answers(s, "BED_MESH_PROFILE SAVE=../x")[0]


def test_damaged_mesh_is_named_at_the_start_and_stays(tmp_path):
    (tmp_path / "meshes").mkdir()
    path = tmp_path / "meshes" / "pei.csv"
    path.write_text("no mesh\n")
    with Scenario(machine(), state=str(tmp_path)) as s:
        assert s.printer.levelling.correction.meshes.all == {}
        assert len(s.printer.levelling.correction.meshes.refused) == 1
    assert path.read_text() == "no mesh\n"


def test_stored_correction_has_one_line_at_the_start(tmp_path):
    with homed(state=str(tmp_path)) as s:
        answers(s, "G29")
        answers(s, "M500")
    with Scenario(machine(), state=str(tmp_path)) as s:
        said = answers(s, "M501")
        assert said[0] == "echo:Stored correction of the bed is as it was, and on (19 values)"
        assert said[1].startswith("echo:To go back")


def test_g32_of_a_mesh_corrects_the_bed():
    with homed() as s:
        answers(s, "G32")
        bed = simulated_bed(s.machine).shape
        assert s.printer.motion.correction.on
        assert s.printer.motion.correction.expected(15, 15) == pytest.approx(
            bed.height(15, 15), abs=STEP
        )
        answers(s, "M561")
        assert answers(s, "G32 D")[0].startswith("//ProbeHeight@P1 ")
        assert not s.printer.motion.correction.on


def test_mesh_is_zero_at_the_reference():
    area = "area = [15.0, 15.0, 215.0, 205.0]"
    with homed((area, f"{area}\nreference = [100, 100]")) as s:
        answers(s, "G29")
        bed = simulated_bed(s.machine).shape
        wanted = bed.height(15, 15) - bed.height(100, 100)
        assert s.printer.motion.correction.expected(15, 15) == pytest.approx(wanted, abs=2 * STEP)


def test_areas_to_avoid_are_measured_around():
    area = "area = [15.0, 15.0, 215.0, 205.0]"
    with homed((area, f"{area}\navoid = [[75, 100, 90, 120]]")) as s:
        # The nozzle is 25 mm right of the probe and 5 mm in front of it.
        s.board.spoil_probe(dead_areas=[(100, 95, 115, 115)])
        answers(s, "G29")
        assert s.printer.motion.correction.on
        bed = simulated_bed(s.machine).shape
        assert s.printer.motion.correction.expected(81.66, 110) == pytest.approx(
            bed.height(81.66, 110), abs=0.01
        )


def test_mesh_of_the_job_covers_its_objects(tmp_path):
    outline = "[[80,95],[140,95],[140,115],[80,115]]"
    (tmp_path / "a.gcode").write_text(
        f"EXCLUDE_OBJECT_DEFINE NAME=part CENTER=110,105 POLYGON={outline}\nG28\n"
        "BED_MESH_CALIBRATE ADAPTIVE=1 ADAPTIVE_MARGIN=5 PROFILE=pei\nG1 X50 F6000\n"
    )
    with homed(card=str(tmp_path)) as s:
        s.host.ok("M23 a.gcode")
        s.host.ok("M24")
        s.host.expect("Done printing", 300)
        mesh = s.printer.motion.correction.correction.mesh
        assert (mesh.xs[0], mesh.xs[-1], mesh.ys[0], mesh.ys[-1]) == (75, 145, 90, 120)
        assert (len(mesh.xs), len(mesh.ys)) == (3, 3)
        assert s.printer.levelling.correction.meshes.all == {}


def test_grid_is_set_and_reported_as_by_reprapfirmware():
    with homed() as s:
        answers(s, "M557 X20:200 Y20:180 S90:80")
        assert answers(s, "M557") == [
            "Grid: X20.0:200.0, Y20.0:180.0, radius -1.0, X spacing 90.0, Y spacing 80.0, 9 points"
        ]
        assert "P" in answers(s, "M557 P1")[0] or "expected 2 to 41" in answers(s, "M557 P1")[0]
        assert "out of reach" in answers(s, "M557 X20:249 Y20:180 P3")[0]
        answers(s, "M557 P3:2")
        assert s.printer.levelling.bed.grid().count == (3, 2)


def test_nozzle_or_probe_goes_to_a_mesh_point():
    with homed() as s:
        answers(s, "G29")
        answers(s, "G42 I1 J2 F6000")
        assert (s.positions()["x"], s.positions()["y"]) == pytest.approx((81.66, 205), abs=0.02)
        answers(s, "G42 I1 J2 P")
        assert (s.positions()["x"], s.positions()["y"]) == pytest.approx((106.66, 200), abs=0.02)
        assert "I below 4, J below 3" in answers(s, "G42 I4 J0")[0]


def test_g29_has_the_steps_of_reprapfirmware():
    with homed(('method = "mesh"', 'method = "mesh"\ndialect = "rrf"')) as s:
        answers(s, "G29 S0")
        mesh = s.printer.motion.correction.correction.mesh
        answers(s, "G29 S3")
        answers(s, "G29 S2")
        assert not s.printer.motion.correction.on
        answers(s, "G29 S1")
        assert s.printer.motion.correction.correction.mesh == mesh


def test_points_are_options_that_last(tmp_path):
    with homed(state=str(tmp_path)) as s:
        assert answers(s, "M925 IProbeP2X") == ["110"]
        answers(s, "M926 IProbeP2X V120")
        answers(s, "M926 IProbeP3Enabled V0")
        answers(s, "M930")
        point = s.printer.levelling.bed.points[1]
        assert (point.x, point.y) == (120.0, 15.0)
        assert not s.printer.levelling.bed.points[2].enabled
        answers(s, "M500")
        said = answers(s, "SET_PROBE_POINT N=1 X=249")[0]
        assert "Point 1 is out of reach" in said
    with Scenario(machine(), state=str(tmp_path)) as s:
        assert s.printer.levelling.bed.points[1].x == 120.0
        assert not s.printer.levelling.bed.points[2].enabled


def test_klippers_objects_show_the_bed():
    with homed() as s:
        answers(s, "BED_MESH_CALIBRATE PROFILE=pei")
        answers(s, "QUERY_PROBE")
        status = s.printer.status.read()
        found = objects(s.machine, Sections(s.machine), status, {})
        mesh = found["bed_mesh"]()
        heights = s.printer.motion.correction.correction.mesh.heights
        assert mesh["profile_name"] == "pei"
        assert mesh["probed_matrix"] == [[pytest.approx(z) for z in row] for row in heights]
        assert (mesh["mesh_min"], mesh["mesh_max"]) == ([15.0, 15.0], [214.98, 205.0])
        assert len(mesh["mesh_matrix"]) == 9
        assert mesh["profiles"]["pei"]["mesh_params"]["x_count"] == 4
        probe = found["probe"]()
        assert probe["last_query"] is False
        assert probe["last_z_result"] == pytest.approx(heights[-1][-1])
        assert found["manual_probe"]()["is_active"] is False
        settings = found["configfile"]()["settings"]
        assert settings["bed_mesh"]["probe_count"] == (4, 3)
        assert settings["probe"]["z_offset"] == 1.2
        # What Klipper has no word for is shown as a mesh of its method.
        assert status.bed.left_rms_mm == pytest.approx(0, abs=1e-6)
        assert status.bed.rms_mm == pytest.approx(0.157, abs=1e-3)
        assert len(status.bed.surface.rows_mm) == 21


def test_mesh_is_saved_shown_and_faded_as_by_other_firmware():
    with homed() as s:
        answers(s, "G29")
        correction = s.printer.motion.correction
        mesh = correction.correction.mesh
        (shown,) = answers(s, "BED_MESH_MAP")
        found = json.loads(shown.removeprefix("mesh_map_output "))
        assert found["mesh_min"] == [mesh.xs[0], mesh.ys[0]]
        assert found["z_positions"] == [list(row) for row in mesh.heights]
        assert answers(s, 'M374 P"glass.csv"') == ["echo:Height map saved as glass"]
        answers(s, "M376 H10")
        assert correction.correction.fade.end_mm == 10
        answers(s, "M561")
        assert "Mesh glass is in use" in answers(s, 'M375 P"glass.csv"')[0]
        assert correction.correction.mesh == mesh


@pytest.mark.parametrize(
    ("words", "xs", "ys", "interpolation"),
    [
        ("mesh_min=50,60 mesh_max=110,120 probe_count=3", (50, 80, 110), (60, 90, 120), "bicubic"),
        ("MESH_MAX=115,105 ALGORITHM=lagrange", (15, 40, 65, 90, 115), None, "bicubic"),
        ("PROBE_COUNT=3,2 ALGORITHM=lagrange", (15, 115, 215), (15, 205), "bilinear"),
        (
            "MESH_RADIUS=30 MESH_ORIGIN=100,90 ROUND_PROBE_COUNT=3",
            (70, 100, 130),
            (60, 90, 120),
            "",
        ),
    ],
)
def test_words_replace_the_grid_for_one_mesh(words, xs, ys, interpolation):
    with at_home(edited("i3-probe", STILL, MESH[0])) as s:
        answers(s, f"BED_MESH_CALIBRATE {words}")
        now = s.printer.motion.correction.correction
        assert now.mesh.xs == xs
        assert ys is None or now.mesh.ys == ys
        assert interpolation in ("", now.interpolation)
        before = s.machine.levelling.count
        assert s.printer.levelling.bed.grid().count == tuple(before)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("MESH_MIN=90,60 MESH_MAX=80,100", "MESH_MAX is 80,100: expected more than MESH_MIN 90,60"),
        ("PROBE_COUNT=1", "PROBE_COUNT is 1: expected 2 to 41 along each axis"),
        ("PROBE_COUNT=3.5", "PROBE_COUNT is 3.5: expected 2 to 41 along each axis"),
        ("MESH_MIN=5,6,7", "MESH_MIN is 5,6,7: expected two numbers with a comma"),
        ("ALGORITHM=spline", "ALGORITHM is spline: expected bicubic, lagrange, direct"),
        ("METHOD=laser", "METHOD is laser: expected manual, automatic"),
        ("MESH_MAX=400,100", "out of reach"),
    ],
)
def test_words_of_a_mesh_that_are_wrong_are_refused(words, told):
    with homed() as s:
        assert told in " ".join(answers(s, f"BED_MESH_CALIBRATE {words}"))
        assert not s.printer.motion.correction.on


def test_mesh_is_measured_by_the_paper_test():
    with homed() as s:
        line = "BED_MESH_CALIBRATE METHOD=manual MESH_MIN=20,20 MESH_MAX=200,180 PROBE_COUNT=2"
        answers(s, line)
        for n in range(4):
            answers(s, f"TESTZ Z={-s.printer.motion.prober.z_mm + 0.1 * n}")
            answers(s, "ACCEPT")
        mesh = s.printer.motion.correction.correction.mesh
        assert (mesh.xs, mesh.ys) == ((20, 200), (20, 180))
        assert mesh.heights == ((0.0, 0.1), (0.3, 0.2))  # in a zigzag
