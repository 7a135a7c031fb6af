"""Meshes, areas and what the core's map gets of them."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import pytest

from passo.errors import CommandError
from passo.levelling.areas import Grid, check_avoided, places_around
from passo.levelling.correction import Correction, Fade, apply
from passo.levelling.fits import Fit
from passo.levelling.mesh import Mesh

PLACES = (20.0, 60.0, 100.0, 140.0, 180.0)
MESH = Mesh(
    PLACES,
    PLACES,
    (
        (0.10, 0.04, 0.00, 0.03, 0.09),
        (0.06, -0.01, -0.05, -0.02, 0.05),
        (0.02, -0.06, -0.10, -0.07, 0.01),
        (0.07, 0.00, -0.04, -0.01, 0.06),
        (0.14, 0.07, 0.03, 0.06, 0.12),
    ),
)
BED = (0.0, 0.0, 200.0, 200.0)


@pytest.mark.parametrize(
    ("at", "bilinear", "bicubic"),
    [
        ((40, 40), 0.047500, 0.044375),
        ((50, 70), -0.004375, -0.009927),
        ((133, 87), -0.059000, -0.070901),
        ((170, 30), 0.064375, 0.061328),
        ((20, 20), 0.1, 0.1),
        ((100, 100), -0.1, -0.1),
        ((180, 180), 0.12, 0.12),
        ((60, 60), -0.01, -0.01),
        ((0, 100), 0.02, 0.02),
        ((200, 210), 0.12, 0.12),
    ],
)
def test_golden_heights_between_points(at, bilinear, bicubic):
    assert MESH.height(*at) == pytest.approx(bilinear, abs=1e-6)
    assert MESH.height(*at, "bicubic") == pytest.approx(bicubic, abs=1e-6)


def test_golden_heights_of_a_refined_mesh():
    fine = MESH.refined(4)
    assert len(fine.xs) == 17
    heights = [fine.height(*at) for at in ((40, 40), (50, 70), (133, 87), (170, 30))]
    assert heights == pytest.approx([0.044375, -0.009927, -0.069993, 0.061328], abs=1e-6)


def test_two_points_an_axis_are_a_plane_in_both():
    mesh = Mesh((0.0, 10.0), (0.0, 20.0), ((0.0, 1.0), (2.0, 3.0)))
    assert mesh.height(2.5, 5, "bicubic") == pytest.approx(mesh.height(2.5, 5)) == 0.75


def rms(mesh, bed, interpolation):
    correction = Correction(mesh=mesh, interpolation=interpolation)
    first, spacing, heights = correction.even_map(BED)
    xs = tuple(first[0] + spacing[0] * k for k in range(len(heights[0])))
    ys = tuple(first[1] + spacing[1] * k for k in range(len(heights)))
    core = Mesh(xs, ys, tuple(map(tuple, heights)))
    errors = [core.height(x, y) - bed(x, y) for x in range(0, 201, 5) for y in range(0, 201, 5)]
    return sqrt(sum(e * e for e in errors) / len(errors))


@pytest.mark.parametrize(
    ("name", "n", "bilinear", "bicubic"),
    [
        ("dome", 5, 0.0174, 0.0011),
        ("dome", 7, 0.0077, 0.0005),
        ("hill", 5, 0.0103, 0.0030),
        ("hill", 9, 0.0027, 0.0003),
        ("waves", 7, 0.017, 0.009),
        ("waves", 9, 0.010, 0.004),
    ],
)
def test_what_the_cores_map_differs_from_the_bed(name, n, bilinear, bicubic):
    def dome(x, y):
        return 0.4 * (1 - (((x - 100) / 100) ** 2 + ((y - 100) / 100) ** 2) / 2)

    def hill(x, y):
        return 0.2 * cos(pi * x / 200) * cos(pi * y / 200)

    def waves(x, y):
        return 0.1 * sin(2 * pi * x / 120) * cos(2 * pi * y / 160)

    bed = {"dome": dome, "hill": hill, "waves": waves}[name]
    mesh = Grid(BED, (n, n)).mesh(bed)
    assert rms(mesh, bed, "bilinear") == pytest.approx(bilinear, abs=0.0006)
    assert rms(mesh, bed, "bicubic") == pytest.approx(bicubic, abs=0.0006)


def test_zero_at_a_reference_point():
    mesh = MESH.lowered(MESH.height(100, 100, "bilinear"))
    assert mesh.heights[0] == pytest.approx((0.2, 0.14, 0.1, 0.13, 0.19))
    assert mesh.range == pytest.approx((0, 0.24))
    assert mesh.mean == pytest.approx(MESH.mean + 0.1)


REFUSED = {
    "one column": (((0.0,), (0.0, 1.0), ((0.0,), (0.0,))), "1 in X: expected 2"),
    "a short row": (((0.0, 1.0), (0.0, 1.0), ((0.0, 1.0), (0.0,))), r"2 rows of \[1, 2\]"),
    "uneven": (
        ((0.0, 1.0, 3.0), (0.0, 1.0), ((0.0,) * 3,) * 2),
        "X 1 is not on the even grid of the mesh: expected 1.5 mm",
    ),
    "falling": (((1.0, 0.0), (0.0, 1.0), ((0.0,) * 2,) * 2), "X 1 is not"),
    "no number": (
        ((0.0, 1.0), (0.0, 1.0), ((0.0, 0.0), (float("inf"), 0.0))),
        "height at point 3 is inf",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_not_a_mesh_is_refused(name):
    made_of, words = REFUSED[name]
    with pytest.raises(CommandError, match=words):
        Mesh(*made_of)


def test_points_are_probed_in_a_zigzag():
    grid = Grid((10.0, 10.0, 210.0, 110.0), (4, 2))
    assert grid.xs == (10, 76.66, 143.32, 209.98)
    assert grid.probed() == [
        *((x, 10.0) for x in grid.xs),
        *((x, 110.0) for x in reversed(grid.xs)),
    ]


def test_a_round_bed_is_probed_within_its_radius():
    grid = Grid((-80.0, -80.0, 80.0, 80.0), (5, 5), radius=80)
    assert len(grid.probed()) == 13
    mesh = grid.mesh(lambda x, y: x + 10 * y)
    assert mesh.heights[0] == (-800,) * 5  # the one point of its row
    assert mesh.heights[1] == (-440, -440, -400, -360, -360)


@pytest.mark.parametrize(
    ("job", "area", "count"),
    [
        ((80, 95, 140, 115), (75, 90, 145, 120), (3, 3)),
        ((5, 60, 215, 80), (10, 55, 210, 85), (7, 4)),
    ],
)
def test_golden_grids_of_a_job(job, area, count):
    adapted = Grid((10.0, 10.0, 210.0, 210.0), (7, 7)).adapted(job, 5)
    assert adapted.area == area
    assert adapted.count == count


def test_job_outside_the_mesh_is_refused():
    with pytest.raises(CommandError, match=r"X-50 to X-20, Y0 to Y10, outside of the mesh"):
        Grid(BED, (5, 5)).adapted((-50, 0, -20, 10), 5)


def test_a_point_in_an_avoided_area_is_probed_around_it():
    avoid = [(40.0, 40.0, 70.0, 80.0)]
    assert places_around(100, 50, BED, avoid) == [(100, 50)]
    assert places_around(50, 60, BED, avoid) == [(39.99, 60), (70.01, 60), (50, 39.99), (50, 80.01)]
    assert places_around(50, 60, (45.0, 45.0, 200.0, 200.0), avoid) == [(70.01, 60), (50, 80.01)]
    with pytest.raises(CommandError, match=r"X50 Y60 lies in .* X40 to X70, Y40 to Y80"):
        places_around(50, 60, (45.0, 45.0, 65.0, 75.0), avoid)


def test_avoided_areas_must_not_overlap():
    check_avoided([(0, 0, 10, 10), (10, 0, 20, 10)])
    with pytest.raises(CommandError, match="X0 to X10, Y0 to Y10 and X9 to X20, Y9 to Y20 overlap"):
        check_avoided([(0, 0, 10, 10), (9, 9, 20, 20)])
    with pytest.raises(CommandError, match="X10 to X0, Y0 to Y10 is empty"):
        check_avoided([(10, 0, 0, 10)])


@pytest.mark.parametrize(
    ("z", "factor"), [(0.2, 1), (2, 0.888889), (5.5, 0.5), (9, 0.111111), (20, 0)]
)
def test_golden_factors_of_a_fade(z, factor):
    fade = Fade(1, 10, target_mm=0.01)
    assert fade.factor(z) == pytest.approx(factor, abs=1e-6)
    correction = Correction(mesh=MESH, interpolation="bilinear", fade=fade)
    assert correction.height(20, 20, z) == pytest.approx(0.01 + 0.09 * factor, abs=1e-6)


class Core:
    def __init__(self):
        self.maps = []

    def set_height_map(self, *args):
        self.maps.append(args)


def test_a_plane_is_one_cell_of_the_core():
    core = Core()
    apply(Correction(fit=Fit(0.1, 0.01, -0.02)), BED, core)
    ((first, spacing, heights),) = core.maps
    assert (first, spacing) == ((0, 0), (200, 200))
    assert heights == [pytest.approx([0.1, 2.1]), pytest.approx([-3.9, -1.9])]


def test_a_quadric_is_cut_into_cells_of_5_mm():
    fit = Fit(0.4, 0, 0, 2e-5, 3e-5, -2e-5)
    first, spacing, heights = Correction(fit=fit).even_map(BED)
    assert (first, spacing, len(heights)) == ((0, 0), (5, 5), 41)
    between = sum(heights[j][i] for j in (20, 21) for i in (7, 8)) / 4
    assert between == pytest.approx(fit.height(37.5, 102.5), abs=0.25e-3)


def test_a_fit_and_a_mesh_make_one_map_over_the_whole_bed():
    correction = Correction(Fit(0.1, 0.001), MESH, "bilinear")
    first, spacing, heights = correction.even_map(BED)
    assert (first, spacing) == ((-20, -20), (40, 40))
    assert [len(row) for row in heights] == [7] * 7
    assert heights[1][1] == pytest.approx(MESH.heights[0][0] + 0.12)
    more = correction.accumulated(Fit(0.01))
    assert more.even_map(BED)[2][1][1] == pytest.approx(heights[1][1] + 0.01)


def test_a_fade_shorter_than_the_bed_differs_is_refused():
    core = Core()
    apply(Correction(mesh=MESH, fade=Fade(1, 1.2)), BED, core)
    assert core.maps[0][3] == (1, 1.2, 0)
    with pytest.raises(CommandError, match=r"fades over 0\.1 mm, but the bed differs by 0\.140 mm"):
        apply(Correction(mesh=MESH, fade=Fade(1, 1.1)), BED, core)
    apply(None, BED, core)
    assert len(core.maps) == 2
    assert core.maps[1][2] == []
