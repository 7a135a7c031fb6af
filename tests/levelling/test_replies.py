"""Tables of heights as hosts read them, and files of meshes."""

from __future__ import annotations

from random import Random

import pytest
from tests.support.bed_visualizer import drawn

from passo.errors import CommandError
from passo.levelling import replies
from passo.levelling.mesh import Mesh
from passo.levelling.mesh_files import (
    StoredMesh,
    bed_mesh_status,
    check_name,
    from_csv,
    profile_data,
    to_csv,
)

MESH = Mesh((20.0, 60.0, 100.0), (10.0, 50.0), ((0.0, -0.075, 0.1), (0.2, 0.05, -0.1)))


TABLES = {
    "bilinear": (replies.bilinear_grid(MESH), 2, 1),
    "klipper": (replies.probed_rows(MESH), 1, 0),
}


@pytest.mark.parametrize("name", TABLES)
def test_bed_visualizer_reads_each_table(name):
    lines, _, _ = TABLES[name]
    assert drawn([*lines, "ok"]) == [pytest.approx(row, abs=1e-3) for row in MESH.heights]


@pytest.mark.parametrize("name", TABLES)
def test_screens_read_each_table_after_its_heading(name):
    lines, skipped, columns = TABLES[name]
    rows = [[float(n) for n in line.split()[columns:]] for line in lines[skipped:]]
    assert rows == [pytest.approx(row, abs=1e-3) for row in MESH.heights]


def test_grid_in_the_form_of_marlin():
    assert replies.bilinear_grid(MESH) == [
        "Bilinear Leveling Grid:",
        "      0      1      2",
        " 0 +0.000 -0.075 +0.100",
        " 1 +0.200 +0.050 -0.100",
    ]


def test_a_mesh_is_the_same_bit_for_bit_after_a_file():
    random = Random(1)
    xs, ys = tuple(10 + 33.33 * i for i in range(6)), tuple(-7 + 21.7 * j for j in range(4))
    mesh = Mesh(xs, ys, tuple(tuple(random.gauss(0, 0.1) for _ in xs) for _ in ys))
    stored = StoredMesh("pei", mesh, "2026-11-25 02:00", 60.5, "probe at X100 Y100", "bilinear")
    assert from_csv(to_csv(stored), "pei") == stored


def test_a_map_of_reprapfirmware_itself_is_read():
    text = """RepRapFirmware height map file v2 generated at 2026-11-25 02:00, min error -0.1
axis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1
X,Y,20.00,100.00,10.00,50.00,-1.00,40.00,40.00,3,2
  0.000, -0.075,  0.100
  0.200,  0.050, -0.100
"""
    stored = from_csv(text, "heightmap")
    assert (stored.mesh, stored.date, stored.bed_c) == (MESH, "2026-11-25 02:00", None)
    older = text.replace(
        "axis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1",
        "xmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum",
    ).replace("X,Y,", "")
    assert from_csv(older, "old").mesh == MESH


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("RepRap", "Rep", 1),
        ("40.0,3,2", "40.0,3", 3),
        ("-0.075", "", 4),
        ("0.05, -0.1", "0.05", 5),
        ('"bed_c": 60', '"bed_c": "x"', 6),
        (';passo {"', ";passo {", 6),
    ],
)
def test_a_damaged_mesh_names_its_line(old, new, line):
    text = to_csv(StoredMesh("a", MESH, "2026-11-25 02:00", 60))
    assert old in text
    with pytest.raises(CommandError, match=f"a:{line}: ") as caught:
        from_csv(text.replace(old, new, 1), "a")
    assert caught.value.problems[0].code == "levelling.mesh-file"


def test_names_of_meshes_stay_in_their_folder():
    assert check_name("pei_60.2") == "pei_60.2"
    for name in ("", "../a", "a/b", ".a", "a" * 41):
        with pytest.raises(CommandError, match="cannot be the name of a mesh"):
            check_name(name)


def test_profile_in_the_form_of_klipper():
    stored = StoredMesh("pei", MESH)
    assert profile_data(stored)["points"] == [[0.0, -0.075, 0.1], [0.2, 0.05, -0.1]]
    params = profile_data(stored)["mesh_params"]
    assert (params["max_x"], params["x_count"], params["y_count"]) == (100.0, 3, 2)
    none = bed_mesh_status(None, {"pei": stored})
    assert (none["mesh_matrix"], list(none["profiles"])) == ([[]], ["pei"])
    status = bed_mesh_status(stored, {})
    assert (status["mesh_min"], status["mesh_max"]) == ([20.0, 10.0], [100.0, 50.0])
    assert [len(row) for row in status["mesh_matrix"]] == [9] * 5
    assert status["mesh_matrix"][4][8] == status["probed_matrix"][1][2] == -0.1
