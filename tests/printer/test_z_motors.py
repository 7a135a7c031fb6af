"""The motors of Z level the gantry, and homing keeps it level; by what the mechanics do."""

import re

import pytest
from tests.support.edited_machine import answers, at_home, edited
from tests.support.scenario import Scenario

from passo.config.exporting.settings import Sections
from passo.errors import ConfigError
from passo.printer.klipper.objects import objects

OFF = "endstops_mm = { z1 = 0.6 }"
NOISE = "noise_mm = 0.002"
PINS = 'stepper_pins = { z = "^Z_MIN", z1 = "^X_MAX" }'
ONE = '[steppers.z1]\nsteps_per_mm = 400.0\nsocket = "E1"\n'
TWO_MORE = """
[steppers.z2]
steps_per_mm = 400.0
step_pin = "PK1"
direction_pin = "PK2"

[steppers.z3]
steps_per_mm = 400.0
step_pin = "PK3"
direction_pin = "PK4"
"""
PIVOTS = "pivots = { z = [-30.0, 110.0], z1 = [280.0, 110.0] }"
POINTS = "points = [{ x = 15, y = 110 }, { x = 205, y = 110 }]"
CORNERS = ", ".join(
    f"{{ x = {x}, y = {y} }}" for x, y in ((15, 15), (15, 205), (205, 205), (205, 15))
)
FOUR = [
    (PINS, 'pin = "^Z_MIN"'),
    (OFF, ""),
    (ONE, ONE + TWO_MORE),
    (PIVOTS, "pivots = { z = [-30, -20], z1 = [-30, 240], z2 = [280, 240], z3 = [280, -20] }"),
    (POINTS, f"points = [{CORNERS}]"),
]


def machine(*changes):
    return edited("i3-two-z", *changes)


def homed(*changes, **options):
    return at_home(machine(*changes), **options)


def tilt(s):
    """The height of motor z1 above that of z, mm."""
    at = s.positions()
    return at["z1"] - at["z"]


def test_gantry_gets_level_and_stays_so_after_homing():
    with homed() as s:
        assert tilt(s) == pytest.approx(0.6, abs=0.01)
        said = answers(s, "G34")
        assert "stepper_z = 0.5" in said[2]
        assert abs(tilt(s)) <= 0.01
        # Z is 0 where the probe finds the bed, 0.15 mm up.
        at = s.positions()
        assert s.printer.rig.job.machine_position[2] == pytest.approx(at["z"] - 0.15, abs=0.01)
        for _ in range(2):
            s.host.ok("G28", 60)
            assert abs(tilt(s)) <= 0.01
            at = s.positions()
            assert s.printer.rig.job.machine_position[2] == pytest.approx(at["z"] - 0.15, abs=0.01)


def test_offsets_survive_restarts_bit_for_bit(tmp_path):
    state = str(tmp_path)
    with homed(state=state) as s:
        answers(s, "G34")
        offsets = answers(s, "M666")
        answers(s, "M500")
        s.host.send("M112")
        s.passes(1)
        s.host.ok("M999", 60)
        assert answers(s, "M666") == offsets
    with Scenario(machine(), state=state) as s:
        assert answers(s, "M666") == offsets
        s.host.ok("G28", 60)
        assert abs(tilt(s)) <= 0.01
        answers(s, "M502")
        assert answers(s, "M666") == ["  M666 S1 Z0.000000", "  M666 S2 Z0.000000"]


def test_offsets_of_the_machine_file_and_of_m666_level_the_motors():
    with homed((PINS, f"{PINS}\noffsets_mm = {{ z1 = 0.6 }}")) as s:
        assert abs(tilt(s)) <= 0.005
        assert s.printer.rig.job.machine_position[2] == pytest.approx(0.6)
        answers(s, "M666 Z-0.4")
        s.host.ok("G28", 60)
        assert tilt(s) == pytest.approx(1.0, abs=0.005)
        assert s.printer.rig.job.machine_position[2] == 0.0
        assert "S is 3: expected 1 to 2" in answers(s, "M666 S3 Z0")[0]


def test_four_belts_get_level_without_endstops_of_their_own():
    with homed(*FOUR, (NOISE, "")) as s:
        for name, mm in (("z1", 0.4), ("z2", -0.3), ("z3", 0.2)):
            s.board.place(name, s.board.position(name) + mm)
        said = answers(s, "QUAD_GANTRY_LEVEL")
        assert "G28 keeps it level" not in said[-1]
        at = s.positions()
        heights = [at[name] for name in ("z", "z1", "z2", "z3")]
        assert max(heights) - min(heights) <= 0.01
        assert s.printer.rig.job.machine_position[2] == pytest.approx(at["z"] - 0.15, abs=0.01)


def test_klippers_object_shows_the_gantry_level_until_motors_go_off():
    with homed((NOISE, "")) as s:

        def applied():
            return objects(s.machine, Sections(s.machine), s.printer.status.read(), {})["z_tilt"]()[
                "applied"
            ]

        assert not applied()
        answers(s, "G34")
        assert applied()
        s.host.ok("G28", 60)
        assert applied()
        answers(s, "M84")
        assert not applied()


def test_tilt_beyond_the_limit_is_refused_and_nothing_moves():
    with homed((OFF, "endstops_mm = { z1 = 2.4 }")) as s:
        before = tilt(s)
        says = r"motor z would move 2\.\d+ mm relative to another motor: at most 2 mm"
        assert re.search(says, answers(s, "G34")[-1])
        assert tilt(s) == pytest.approx(before, abs=1e-9)
        assert not s.printer.rig.job.locked_axes


def test_motors_in_the_wrong_order_stop_at_the_first_rise():
    with homed() as s:
        commands = s.printer.dispatch.planned["G34"].__self__
        pivots = commands._config.pivots
        swapped = {"z": pivots["z1"], "z1": pivots["z"]}
        commands._config = commands._config.model_copy(update={"pivots": swapped})
        assert "Probably the Z motors z, z1 are in another order" in answers(s, "G34")[-1]


def test_tilt_that_stays_is_an_error():
    with homed() as s:
        says = r"still tilt by 0\.\d+ mm after 0 adjustments: at most 0\.01 mm"
        assert re.search(says, answers(s, "Z_TILT_ADJUST RETRIES=0")[-1])


def test_z_is_not_homed_after_a_stop_on_the_way():
    with homed(("trigger_height_mm", "lift_mm_s = 1.0\ntrigger_height_mm")) as s:
        s.host.send("G34")
        while tilt(s) > 0.55:
            s.passes(0.02)
        s.host.send("M410")
        s.passes(1)
        assert 0.1 < tilt(s) < 0.55
        assert s.printer.rig.job.locked_axes == [2]
        s.host.ok("G28", 60)
        assert tilt(s) == pytest.approx(0.6, abs=0.01)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("z1 = [280.0, 110.0]", "z2 = [280.0, 110.0]", "a pivot for each motor of Z: z, z1"),
        ("z1 = [280.0, 110.0]", "z1 = [-30.0, 110.5]", "at least 1 mm from that of z"),
        ("{ x = 205, y = 110 }", "{ x = 245, y = 110 }", r"points\[1\] is 'X245 Y110'"),
        (PINS, f"{PINS}\noffsets_mm = {{ y = 0.6 }}", "a motor in stepper_pins"),
    ],
)
def test_motors_that_cannot_level_are_refused(old, new, says):
    with pytest.raises(ConfigError, match=says):
        machine((old, new))
