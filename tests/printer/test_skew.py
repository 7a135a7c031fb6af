"""Axes that are not at right angles: the motors follow the law of M852, by the mechanics."""

import pytest
from tests.support.edited_machine import answers, at_home, edited
from tests.support.scenario import Scenario

from passo._core import Geometry
from passo.config.exporting.settings import Sections
from passo.errors import ConfigError
from passo.printer.klipper.objects import objects

XY, XZ, YZ = -0.016951, 0.004, -0.002
LIMITED = [
    (f"[steppers.{axis}]\n", f"[steppers.{axis}]\nmin_mm = -2.0\nmax_mm = {most}\n")
    for axis, most in (("x", 252.0), ("y", 222.0))
]


def machine(*changes):
    return edited("i3", *changes)


def homed(**options):
    return at_home(machine(*LIMITED), **options)


def motors(x, y, z, xy=XY, xz=XZ, yz=YZ):
    """Where Marlin and Klipper put the axes for a place of the nozzle."""
    return x - y * xy - z * (xz - xy * yz), y - z * yz, z


@pytest.mark.parametrize("kind", ["cartesian", "delta"])
def test_skew_is_applied_before_the_geometry(kind):
    spec = {"kind": kind}
    if kind == "delta":
        spec |= {"radius": 81.0, "rods": [160.0] * 3, "angles": [210.0, 330.0, 90.0]}
        spec |= {"limit_radius": 75.0}
    straight, skewed = Geometry(spec), Geometry(spec | {"skew": [XY, XZ, YZ]})
    a, b, s = (10.0, -30.0, 5.0), (-20.0, 25.0, 15.0), 17.0
    length = sum((q - p) ** 2 for p, q in zip(a, b, strict=True)) ** 0.5
    at = tuple(p + (q - p) * s / length for p, q in zip(a, b, strict=True))
    for i in range(3):
        assert skewed.inverse(i, at) == pytest.approx(straight.inverse(i, motors(*at)), abs=1e-12)
        first, second = (
            skewed.inverse(
                i, tuple(p + (q - p) * (s + h) / length for p, q in zip(a, b, strict=True))
            )
            for h in (-1e-4, 1e-4)
        )
        slope, _ = skewed.slopes(i, a, b, s)
        assert slope == pytest.approx((second - first) / 2e-4, abs=1e-7)
        places, _ = skewed.crossings(i, a, b, 10.0)
        for place in places:
            q = skewed.inverse(
                i, tuple(p + (v - p) * place / length for p, v in zip(a, b, strict=True))
            )
            assert (10 * q) % 1 == pytest.approx(0.5, abs=1e-6)
    assert skewed.forward(tuple(skewed.inverse(i, at) for i in range(3))) == pytest.approx(at)


def test_motors_follow_the_skew_formula():
    with homed() as s:
        answers(s, f"M852 I{XY} J{XZ} K{YZ}")
        for place in ((100, 200, 20), (200, 10, 50), (20, 150, 0.2)):
            x, y, z = place
            answers(s, f"G1 X{x} Y{y} Z{z} F9000")
            answers(s, "M400")
            at = s.positions()
            found = [at["x"], at["y"], at["z"]]
            assert found == pytest.approx(motors(x, y, z), abs=0.5 / 80 + 1e-4)


def test_setting_skew_moves_no_motor_and_homing_takes_the_endstops():
    with homed() as s:
        answers(s, "G1 X50 Y100 Z10 F9000")
        answers(s, "M400")
        before = s.positions()
        answers(s, f"M852 I{XY}")
        assert s.positions() == before
        assert s.printer.rig.job.machine_position[:3] == pytest.approx([50 + 100 * XY, 100, 10])
        s.host.ok("G28 X", 60)
        assert s.positions()["x"] == pytest.approx(0, abs=0.0126)
        assert s.printer.rig.job.machine_position[:3] == pytest.approx([100 * XY, 100, 10])
        s.host.ok("G28", 60)
        assert s.printer.rig.job.machine_position[:3] == pytest.approx([0, 0, 0], abs=1e-9)
        answers(s, "SET_SKEW CLEAR=1")
        assert answers(s, "M852") == ["  M852 I0.000000000 J0.000000000 K0.000000000"]


def test_motor_keeps_within_what_it_reaches():
    with homed() as s:
        answers(s, f"M852 I{XY}")
        said = answers(s, "G1 X250 Y200 F9000")[0]
        assert "motor x would go to 253.390 mm, beyond its limit of 252.000 mm" in said
        answers(s, "M400")
        assert s.positions()["x"] <= 252.0
        assert s.printer.rig.job.machine_position[0] == 0
        assert answers(s, "G1 X245 Y200 F9000") == []


def test_skew_is_found_by_a_printed_square_and_kept(tmp_path):
    state = str(tmp_path)
    with homed(state=state) as s:
        said = answers(s, "CALC_MEASURED_SKEW AC=140.4 BD=142.8 AD=99.8")
        assert said == ["// Calculated Skew: -0.016951, -0.97 degrees"]
        answers(s, "SET_SKEW XY=140.4,142.8,99.8")
        answers(s, "M500")
        assert answers(s, "GET_CURRENT_SKEW")[1] == "// XY Skew: -0.016951, -0.97 degrees"
        skew = s.printer.rig.machine.geometry.skew
    with Scenario(machine(*LIMITED), state=state) as s:
        assert s.printer.rig.machine.geometry.skew == skew
        s.host.ok("G28", 60)
        answers(s, "G1 Y100 X100 F9000")
        answers(s, "M400")
        assert s.positions()["x"] == pytest.approx(101.695, abs=0.01)


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("M852 I0.3", "I is 0.3: expected -0.2 to 0.2"),
        ("SET_SKEW XY=1,2", "XY is 1,2: expected the lengths AC,BD,AD in mm"),
        ("SET_SKEW XY=100,300,20", "no parallelogram has the lengths"),
        ("SET_SKEW", "needs XY="),
    ],
)
def test_skew_that_makes_no_sense_is_refused(line, says):
    with homed() as s:
        assert says in answers(s, line)[0]


def test_skew_needs_limits_of_the_motors():
    with Scenario("i3") as s:
        said = answers(s, "M852 I0.01")[0]
        assert "steppers.x.min_mm of the machine file is missing, expected what this motor" in said
    skewed = ('kind = "cartesian"', 'kind = "cartesian"\nskew = [0.01, 0.0, 0.0]')
    with pytest.raises(ConfigError, match=r"steppers\.x\.min_mm"):
        machine(skewed)
    assert machine(skewed, *LIMITED).geometry.skew == [0.01, 0.0, 0.0]


@pytest.mark.parametrize(
    ("kind", "own", "carriages"),
    [
        ("corexy", "z", lambda p: ((p["a"] + p["b"]) / 2, (p["a"] - p["b"]) / 2, p["z"])),
        ("corexz", "y", lambda p: ((p["a"] + p["b"]) / 2, p["y"], (p["a"] - p["b"]) / 2)),
    ],
)
def test_carriages_on_crossed_belts_follow_the_formula(kind, own, carriages):
    reach = f'kind = "{kind}"\nreach_x_mm = [-5, 310]\nreach_y_mm = [-5, 310]'
    changes = ('kind = "corexy"', reach), ("[steppers.z", f"[steppers.{own}")
    with at_home(edited("corexy", *changes)) as s:
        answers(s, f"M852 I{XY} J{XZ} K{YZ}")
        for place in ((100, 200, 20), (200, 10, 50), (20, 150, 0.2)):
            x, y, z = place
            answers(s, f"G1 X{x} Y{y} Z{z} F9000")
            answers(s, "M400")
            found = carriages(s.positions())
            assert found == pytest.approx(motors(x, y, z), abs=1 / 80 + 1e-4)
        answers(s, "G28")
        assert carriages(s.positions()) == pytest.approx((0, 0, 0), abs=0.03)


def test_skew_keeps_carriages_of_crossed_belts_within_their_reach():
    with at_home(
        edited("corexy", ('kind = "corexy"', 'kind = "corexy"\nreach_x_mm = [-2, 252]'))
    ) as s:
        (said,) = answers(s, "M852 I0.1")
        assert "geometry.reach_x_mm of the machine file is [-2.0, 252.0], expected at least" in said
        (said,) = answers(s, "M852 K0.1")
        assert "geometry.reach_y_mm of the machine file is missing" in said
        assert s.printer.rig.machine.geometry.skew == [0.0, 0.0, 0.0]


def test_profiles_of_skew_are_saved_loaded_and_removed(tmp_path):
    with homed(state=str(tmp_path)) as s:
        answers(s, f"M852 I{XY}")
        (said,) = answers(s, "SKEW_PROFILE SAVE=pla")
        assert said == "// The skew is saved as profile [pla]; M500 stores it"
        answers(s, "M500")
    with homed(state=str(tmp_path)) as s:
        shown = {"current_profile_name": "pla"}
        assert (
            objects(s.machine, Sections(s.machine), s.printer.status.read(), {})[
                "skew_correction"
            ]()
            == shown
        )
        answers(s, "SET_SKEW CLEAR=1")
        assert s.printer.status.read().skew_profile == ""
        assert answers(s, "SKEW_PROFILE") == ["// pla: XY=-0.016951 XZ=0.000000 YZ=0.000000"]
        answers(s, "SKEW_PROFILE LOAD=pla")
        assert s.printer.rig.machine.geometry.skew == [XY, 0.0, 0.0]
        (said,) = answers(s, "SKEW_PROFILE LOAD=abs")
        assert "LOAD is abs: expected a profile: pla" in said
        answers(s, "SKEW_PROFILE REMOVE=pla")
        answers(s, "M500")
    with homed(state=str(tmp_path)) as s:
        assert answers(s, "SKEW_PROFILE") == []
