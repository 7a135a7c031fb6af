"""A delta finds its own geometry from probed heights (golden numbers of one wrong machine)."""

from __future__ import annotations

from math import cos, dist, hypot, radians, sin, sqrt
from random import Random

import pytest

from passo.errors import CommandError
from passo.geometry.delta import Delta
from passo.levelling.delta_calibration import (
    ChangeLimits,
    DeltaMachine,
    Distance,
    calibrate,
    printed_distances,
)


def machine(radius, angles, rods, endstops):
    geometry = Delta(kind="delta", radius=radius, rods=rods, angles=angles, limit_radius=100.0)
    return DeltaMachine(geometry, tuple(endstops))


NOMINAL = machine(120.0, [210.0, 330.0, 90.0], [250.0] * 3, [519.317122] * 3)
TRUE = machine(121.2, [210.4, 329.7, 90.0], [250.0] * 3, [519.00626, 518.45626, 518.75626])
PLACES = [(0.0, 0.0)] + [
    (80 * k * cos(radians(90 + 60 * i)), 80 * k * sin(radians(90 + 60 * i)))
    for i, k in enumerate((0.95, 0.90, 0.85, 0.70, 0.75, 0.80))
]
HEIGHTS = [-0.084358, 0.129859, -0.108370, -0.005666, 0.231797, 0.284859, 0.179771]
EXTENDED = machine(
    121.2, [210.4, 329.7, 90.0], [250.6, 249.9, 250.3], [519.692016, 518.341918, 519.099201]
)
EXTENDED_HEIGHTS = [-0.084694, 0.111590, -0.125218, -0.055030, 0.223132, 0.312660, 0.173230]
EXTENDED_DISTANCES = [
    *(64.38685, 64.18035, 64.50439, 64.61710, 64.07590, 64.15706),
    *(64.35671, 64.58919, 64.13958, 64.31868, 64.42882, 64.01715),
]


def values(machine):
    g = machine.geometry
    return [g.radius, *g.angles, *machine.endstops, *g.rods]


def touched(heights):
    """What the machine knows of each point: its drops at the trigger, and that the bed is flat."""
    return [(NOMINAL.drops((x, y, z)), 0.0) for (x, y), z in zip(PLACES, heights, strict=True)]


def towards(angle):
    return cos(radians(angle)), sin(radians(angle))


def pairs():
    directions = [210, 270, 330, 30, 90, 150]
    for angle in directions:
        u, v = towards(angle)
        yield (4.5 * u, 4.5 * v), (69.5 * u, 69.5 * v)
    for i, angle in enumerate(directions):
        u, v = towards(angle)
        p, q = towards(directions[(i + 2) % 6])
        yield (65 * u + 4.5 * p, 65 * v + 4.5 * q), (65 * u + 69.5 * p, 65 * v + 69.5 * q)


def test_golden_calibration_with_six_factors():
    found = calibrate(NOMINAL, touched(HEIGHTS))
    assert values(found.after) == pytest.approx(values(TRUE), abs=1e-5)
    assert found.rms_before == pytest.approx(0.170272, abs=1e-6)
    assert found.rms_after < 1e-6
    found.check(ChangeLimits())
    assert found.changes()[:2] == [
        ("radius", 120.0, pytest.approx(121.2, abs=1e-5)),
        ("angle A", 210.0, pytest.approx(210.4, abs=1e-5)),
    ]
    assert NOMINAL.drops((0, 0, 0)) == pytest.approx(
        TRUE.drops((-0.574917, 0.029588, 0.084358)), abs=2e-6
    )


def test_golden_calibration_of_rods_with_distances():
    distances = [
        Distance(NOMINAL.drops((*a, 0.0)), NOMINAL.drops((*b, 0.0)), mm)
        for (a, b), mm in zip(pairs(), EXTENDED_DISTANCES, strict=True)
    ]
    found = calibrate(NOMINAL, touched(EXTENDED_HEIGHTS), 9, distances)
    assert values(found.after) == pytest.approx(values(EXTENDED), abs=3e-5)
    # The commanded marks are that far apart on the true machine.
    for d in distances:
        far = dist(EXTENDED.nozzle(d.first), EXTENDED.nozzle(d.second))
        assert far == pytest.approx(d.mm, abs=1e-5)


def test_a_common_length_of_rods_is_found_without_noise():
    true = machine(121.0, [210.2, 330.1, 90.0], [250.5] * 3, [519.5, 519.1, 519.3])
    ring = [(0.0, 0.0)] + [
        (r * cos(radians(a)), r * sin(radians(a))) for r in (45, 80) for a in range(0, 360, 60)
    ]
    heights = [(true.drops((x, y, 0.0)), 0.0) for x, y in ring]
    found = calibrate(NOMINAL, heights, 7)
    assert values(found.after) == pytest.approx(values(true), abs=1e-4)


@pytest.mark.parametrize("seed", range(10))
def test_bed_is_flat_within_20_um_after_noisy_probes(seed):
    random = Random(seed)
    drops = [
        (NOMINAL.drops((x, y, z + random.gauss(0, 0.01))), 0.0)
        for (x, y), z in zip(PLACES, HEIGHTS, strict=True)
    ]
    found = calibrate(NOMINAL, drops)
    errors = []
    for x in range(-80, 81, 20):
        for y in range(-80, 81, 20):
            if hypot(x, y) <= 80:
                errors.append(TRUE.nozzle(found.after.drops((x, y, 0.0)))[2])
    assert sqrt(sum(e * e for e in errors) / len(errors)) <= 0.02


def test_rods_need_distances():
    with pytest.raises(CommandError, match=r"rods .* measured distances"):
        calibrate(NOMINAL, touched(HEIGHTS), 9)


def test_too_few_points_are_refused():
    with pytest.raises(CommandError, match="the 5 measurements determine 5 of 6 parameters"):
        calibrate(NOMINAL, touched(HEIGHTS)[:5])


def test_a_change_beyond_its_limit_is_refused():
    found = calibrate(NOMINAL, touched(HEIGHTS))
    with pytest.raises(
        CommandError, match=r"radius would change from 120\.0000 to 121\.2000: at most 1 mm"
    ):
        found.check(ChangeLimits(radius_mm=1))
    with pytest.raises(CommandError, match=r"angle A .* at most 0\.3 degrees"):
        found.check(ChangeLimits(angle_deg=0.3))
    with pytest.raises(CommandError, match=r"endstop B .* 0\.5 mm"):
        found.check(ChangeLimits(endstop_mm=0.5))


def test_a_result_with_a_greater_residual_is_refused():
    found = calibrate(NOMINAL, touched(HEIGHTS))
    worse = type(found)(found.after, found.before, found.rms_after, found.rms_before)
    with pytest.raises(CommandError, match=r"0\.1703 mm rms, before it 0\.0000 mm"):
        worse.check(ChangeLimits())


def test_golden_rods_from_the_lengths_on_a_printed_part():
    center, outer = EXTENDED_DISTANCES[:6], EXTENDED_DISTANCES[6:]
    middle, others = [9.1, 9.0, 8.9], [9.2, 9.1, 9.0, 8.9, 8.8, 8.7]
    distances = printed_distances(
        NOMINAL,
        [mm + middle[k] for mm, k in zip(center, (0, 2, 1, 0, 2, 1), strict=True)],
        middle,
        [mm + width for mm, width in zip(outer, others, strict=True)],
        others,
        1.0,
    )
    found = calibrate(NOMINAL, touched(EXTENDED_HEIGHTS), 9, distances)
    assert values(found.after) == pytest.approx(values(EXTENDED), abs=3e-5)
