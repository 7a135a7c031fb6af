"""The core's kernels against the Python models, and both against brute force."""

from __future__ import annotations

import itertools
from math import atan2, cos, degrees, dist, isnan, radians, sin

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter
from tests.oracles import kinematics
from tests.oracles.geometry import crossings, line

from passo._core import Fault, Geometry
from passo.geometry.base import Unreachable
from passo.geometry.registry import GEOMETRIES, AnyGeometry
from passo.printer.input_errors import problem

# Parameters, and the corners of a box that the machine reaches all of.
CASES = {
    "cartesian": ({"kind": "cartesian"}, (-100.0, -100.0, 0.0), (100.0, 100.0, 100.0)),
    "corexy": ({"kind": "corexy"}, (-100.0, -100.0, 0.0), (100.0, 100.0, 100.0)),
    "corexz": ({"kind": "corexz"}, (-100.0, -100.0, 0.0), (100.0, 100.0, 100.0)),
    "coreyz": ({"kind": "coreyz"}, (-100.0, -100.0, 0.0), (100.0, 100.0, 100.0)),
    "hybrid_corexy": ({"kind": "hybrid_corexy"}, (-100.0, -100.0, 0.0), (100.0, 100.0, 100.0)),
    "hybrid_corexz": ({"kind": "hybrid_corexz"}, (-100.0, -100.0, 0.0), (100.0, 100.0, 100.0)),
    "delta": (
        {"kind": "delta", "radius": 81.0, "rods": [160.0, 160.0, 160.0], "limit_radius": 75.1},
        (-53.0, -53.0, 0.0),
        (53.0, 53.0, 150.0),
    ),
    "uneven delta": (
        {
            "kind": "delta",
            "radius": 81.0,
            "rods": [160.0, 161.5, 158.0],
            "angles": [209.0, 331.5, 90.5],
            "limit_radius": 75.1,
        },
        (-53.0, -53.0, 0.0),
        (53.0, 53.0, 150.0),
    ),
    "deltesian": (
        {"kind": "deltesian", "towers_x": [-160.0, 150.0], "rods": [217.0, 210.0]},
        (-50.0, -100.0, 0.0),
        (50.0, 100.0, 200.0),
    ),
    "rotary_delta": ({"kind": "rotary_delta"}, (-45.0, -45.0, 40.0), (45.0, 45.0, 90.0)),
    "scara": (
        {"kind": "scara", "x_offset": -100.0, "y_offset": -20.0},
        (-80.0, 0.0, 0.0),
        (80.0, 180.0, 100.0),
    ),
    "scara with the elbow motor on the arm": (
        {"kind": "scara", "arm1": 150.0, "arm2": 120.0, "external_motor": False},
        (40.0, -150.0, 0.0),
        (180.0, 150.0, 100.0),
    ),
    "dual_scara": ({"kind": "dual_scara"}, (-30.0, 62.0, 0.0), (30.0, 95.0, 50.0)),
    "polar": ({"kind": "polar"}, (5.0, -80.0, 0.0), (90.0, 70.0, 100.0)),
    "winch": (
        {"kind": "winch", "anchors": [[0, -900, 500], [800, 500, 500.0], [-800, 500, 450]]},
        (-100.0, -100.0, 0.0),
        (100.0, 100.0, 200.0),
    ),
    "winch of four cables": (
        {
            "kind": "winch",
            "anchors": [[0, -900, -50], [800, 500, -50], [-800, 500, -60], [0, 0, 900]],
        },
        (-100.0, -100.0, 0.0),
        (100.0, 100.0, 200.0),
    ),
    "winch of six cables": (
        {
            "kind": "winch",
            "anchors": [
                [x, y, z] for x, y in ((400, 0), (-300, 350), (-300, -350)) for z in (-9, 600)
            ],
        },
        (-100.0, -100.0, 0.0),
        (100.0, 100.0, 200.0),
    ),
    "none": ({"kind": "none"}, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
}
LINES = [name for name in CASES if name != "none"]
NONLINEAR = [name for name in LINES if "core" not in name and name != "cartesian"]
EVERYWHERE = "polar", "winch"  # reach all of a wide box
BOUNDED = [name for name in NONLINEAR if not name.startswith(EVERYWHERE)]


def machine(name):
    parameters, low, high = CASES[name]
    model = TypeAdapter(AnyGeometry).validate_python(parameters)
    return model, Geometry(model.spec()), low, high


def grid(low, high, n=7):
    sides = ([a + (b - a) * i / (n - 1) for i in range(n)] for a, b in zip(low, high, strict=True))
    return list(itertools.product(*sides))


def close(a, b, tolerance=1e-9):
    return all(abs(p - q) <= tolerance for p, q in zip(a, b, strict=True))


def test_every_geometry_has_tests():
    kinds = {case[0]["kind"] for case in CASES.values()}
    names = {model.model_fields["kind"].annotation.__args__[0] for model in GEOMETRIES}
    assert kinds == names


@pytest.mark.parametrize("name", CASES)
def test_core_and_model_agree_and_forward_undoes_inverse(name):
    model, core, low, high = machine(name)
    assert core.actuators == len(model.actuators)
    for point in grid(low, high):
        positions = kinematics.inverse(model, point)
        assert close([core.inverse(i, point) for i in range(core.actuators)], positions), point
        assert close(kinematics.forward(model, positions), point), point
        assert close(core.forward(positions), point), point


@pytest.mark.parametrize("name", BOUNDED)
def test_core_and_model_reach_the_same_points(name):
    model, core, low, high = machine(name)
    wide = (
        [2 * a - b for a, b in zip(low, high, strict=True)],
        [2 * b - a for a, b in zip(low, high, strict=True)],
    )
    reached = 0
    points = grid(*wide, n=12)
    for point in points:
        in_core = not any(isnan(core.inverse(i, point)) for i in range(3))
        try:
            kinematics.inverse(model, point)
        except ValueError:
            assert not in_core, point
            assert not model.reaches(point), point
            assert model.reason(point), point
        else:
            assert in_core, point
            reached += 1
    assert 0 < reached < len(points)


@pytest.mark.parametrize("name", LINES)
def test_slopes_are_the_derivatives(name):
    model, core, low, high = machine(name)
    middle = tuple((a + b) / 2 for a, b in zip(low, high, strict=True))
    for end in grid(low, high, n=3):
        if end == middle:
            continue
        point, length = line(middle, end)
        s, h = 0.4 * length, 1e-3
        for i in range(core.actuators):
            before, here, after = (
                kinematics.inverse(model, point(s + k * h))[i] for k in (-1, 0, 1)
            )
            first, second = core.slopes(i, middle, end, s)
            assert first == pytest.approx((after - before) / (2 * h), abs=1e-7)
            assert second == pytest.approx((after - 2 * here + before) / h**2, abs=2e-6)


fractions = st.tuples(*[st.integers(0, 1000).map(lambda n: n / 1000)] * 3)


@pytest.mark.parametrize("name", NONLINEAR)
@settings(max_examples=25, derandomize=True, deadline=None)
@given(data=st.data())
def test_crossings_equal_brute_force_search(name, data):
    model, core, low, high = machine(name)
    start, end = (
        tuple(a + (b - a) * f for a, b, f in zip(low, high, data.draw(fractions), strict=True))
        for _ in range(2)
    )
    assume(dist(start, end) > 0.1)
    actuator = data.draw(st.integers(0, core.actuators - 1))
    assume(core.linear(actuator) is None)
    point, length = line(start, end)
    expected, margin = crossings(
        lambda s: kinematics.inverse(model, point(s))[actuator], length, 8.0
    )
    assume(margin > 1e-4)  # whether such a step exists is a matter of rounding
    places, directions = core.crossings(actuator, start, end, 8.0)
    assert directions == [direction for _, direction in expected]
    for place, (s, _) in zip(places, expected, strict=True):
        assert abs(place - s) <= 1e-6


@pytest.mark.parametrize("name", NONLINEAR)
def test_crossings_are_equal_in_both_directions(name):
    _, core, low, high = machine(name)
    length = dist(low, high)
    for actuator in [i for i in range(core.actuators) if core.linear(i) is None]:
        there, up = core.crossings(actuator, low, high, 80.0)
        back, down = core.crossings(actuator, high, low, 80.0)
        assert [-d for d in reversed(down)] == up
        assert close([length - s for s in reversed(back)], there, 1e-6)


def test_turn_at_a_sample_is_found_once():
    """An arm of the rotary delta turns in the middle of a line across it, of whole mm."""
    _, core, _, _ = machine("rotary_delta")
    places, directions = core.crossings(0, (-20.0, 0.0, 60.0), (20.0, 0.0, 60.0), 80.0)
    half = len(places) // 2
    assert half > 20
    assert directions == [directions[0]] * half + [-directions[0]] * half
    assert close(places, [40.0 - s for s in reversed(places)], 1e-6)


def test_golden_fisher_delta():
    """RepRapPro's Fisher: all carriages at 200 mm put the nozzle over the middle."""
    model, core, _, _ = machine("delta")
    for forward in (lambda q: kinematics.forward(model, q), model.forward, core.forward):
        x, y, z = forward((200.0, 200.0, 200.0))
        assert (x, y) == pytest.approx((0, 0), abs=1e-9)
        assert z == pytest.approx(62.0181, abs=5e-5)


def test_towers_may_be_numbered_clockwise():
    parameters = CASES["delta"][0] | {"angles": [90.0, 330.0, 210.0]}
    model = TypeAdapter(AnyGeometry).validate_python(parameters)
    core = Geometry(model.spec())
    point = (11.0, -7.0, 23.0)
    positions = tuple(core.inverse(i, point) for i in range(3))
    assert close(core.forward(positions), point)
    assert close(kinematics.forward(model, positions), point)


def test_a_delta_reaches_all_of_the_circle_that_limits_it():
    _, core, _, _ = machine("delta")
    for at in range(360):
        x, y = 75.1 * cos(radians(at)), 75.1 * sin(radians(at))
        assert not isnan(core.inverse(0, (x, y, 0.0)))
    assert isnan(core.inverse(0, (75.1001, 0.0, 0.0)))


def test_angles_of_an_arm_end_where_it_points_inwards():
    """Beyond 180 degrees below the horizon: above it."""
    model, core, _, _ = machine("rotary_delta")
    point = (0.0, 60.0, 260.0)
    angles = [core.inverse(i, point) for i in range(3)]
    assert angles == pytest.approx([121.4274, -174.8845, -174.8845], abs=1e-4)
    assert close(angles, kinematics.inverse(model, point))


@pytest.mark.parametrize("positions", [(0.0, 500.0, 0.0), (400.0, 0.0, 0.0)])
def test_carriages_too_far_apart_have_no_point(positions):
    model, core, _, _ = machine("delta")
    with pytest.raises(ValueError, match="no nozzle position"):
        core.forward(positions)
    with pytest.raises(Unreachable, match="no point belongs"):
        model.forward(positions)


def test_a_joint_on_the_axis_of_a_shoulder_has_no_arm():
    model, _, _, _ = machine("rotary_delta")
    away = (model.base_length - model.effector_length) / (2 * 3**0.5)
    with pytest.raises(Unreachable, match=r"50\.000 to 210\.000 mm there, not 0\.000 mm"):
        model.inverse((0.0, -away, model.z_offset))


@pytest.mark.parametrize(
    ("name", "point", "reason"),
    [
        ("delta", (60.0, 60.0, 0.0), "it is 84.853 mm from the middle (limit 75.100 mm)"),
        (
            "rotary_delta",
            (0.0, 150.0, 40.0),
            "arm A and its rod reach from 50.000 to 210.000 mm there, not 221.302 mm",
        ),
        (
            "scara",
            (200.0, 20.0, 0.0),
            "the arms reach from 0.010 to 299.990 mm from the shoulder, not 302.655 mm",
        ),
        (
            "dual_scara",
            (0.0, 300.0, 0.0),
            "arm A reaches from 10.010 to 129.990 mm from its shoulder, not 304.138 mm",
        ),
    ],
)
def test_out_of_reach_names_value_and_limit(name, point, reason):
    model, _, _, _ = machine(name)
    told = problem((7, Fault.UNREACHABLE, "", 0.0, 0.0, point), "a.gcode", model)
    assert told.place == "a.gcode:7"
    assert told.sentence.endswith(f"cannot be reached by this machine: {reason}")


@pytest.mark.parametrize(("mm", "reached"), [(129.985, True), (129.995, False)])
def test_arms_from_two_shoulders_are_never_quite_stretched(mm, reached):
    """They are 60 and 70 mm, from 50 mm to either side."""
    model, core, _, _ = machine("dual_scara")
    point = (0.0, (mm**2 - 50.0**2) ** 0.5, 0.0)
    assert [isnan(core.inverse(i, point)) for i in (0, 1)] == [not reached] * 2
    if reached:
        assert close(kinematics.forward(model, kinematics.inverse(model, point)), point, 1e-6)
    else:
        with pytest.raises(Unreachable, match="mm from its shoulder, not"):
            model.inverse(point)


@pytest.mark.parametrize(("y", "reached"), [(0.019, False), (0.021, True)])
def test_a_polar_nozzle_keeps_away_from_the_middle(y, reached):
    model, core, _, _ = machine("polar")
    assert [isnan(core.inverse(i, (0.0, y, 3.0))) for i in range(3)] == [not reached] * 2 + [False]
    if not reached:
        with pytest.raises(Unreachable, match=r"0\.019 mm from the middle of the bed.*limit 0\.02"):
            model.inverse((0.0, y, 3.0))


def test_a_polar_bed_turns_half_round_past_the_middle():
    """On a line at 0.06 mm, all the way by less than half a turn, to either side."""
    _, core, _, _ = machine("polar")
    for sign in (1, -1):
        _, directions = core.crossings(0, (-80.0, 0.06 * sign, 0), (80.0, 0.06 * sign, 0), 10.0)
        assert directions == [-sign] * 1800
    _, directions = core.crossings(0, (-80.0, -0.06, 0.0), (-80.0, 0.06, 0.0), 1000.0)
    assert set(directions) == {-1}  # over the end of the angles
    assert len(directions) == pytest.approx(2000 * degrees(atan2(0.06, 80.0)), abs=1)


def test_three_cables_hang_on_the_side_of_the_axes():
    parameters = {"kind": "winch", "anchors": [[0, -900, -50], [800, 500, -50], [-800, 500, -60]]}
    model = TypeAdapter(AnyGeometry).validate_python(parameters).facing((0, 0, 100.0), [])
    point = (30.0, -20.0, 70.0)
    assert close(model.forward(model.inverse(point)), point, 1e-6)


def test_anchors_on_one_line_are_refused():
    anchors = [[0.0, 0.0, 500.0], [100.0, 100.0, 500.0], [300.0, 300.0, 500.0]]
    with pytest.raises(ValueError, match="must not lie on one line"):
        TypeAdapter(AnyGeometry).validate_python({"kind": "winch", "anchors": anchors})


def test_a_nozzle_at_an_anchor_has_no_cable():
    model, core, _, _ = machine("winch")
    assert isnan(core.inverse(1, (800.0, 500.0, 500.5)))
    with pytest.raises(Unreachable, match=r"cable B is 0\.500 mm long there \(limit 1 mm\)"):
        model.inverse((800.0, 500.0, 500.5))
