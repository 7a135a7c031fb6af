"""The probe is the endstop of Z: it homes over the bed, with X and Y homed."""

import pytest
from tests.support.scenario import Scenario

from passo.config.load import load_text, shipped_text
from passo.errors import ConfigError
from passo.printer.setup.simulated_world import simulated_bed

STEP = 1 / 400
_ENDSTOP = """\
[homing.z]
direction = "min"
position = 0.0
pin = "^Z_MIN"
fast = 5.0
slow = 1.0
"""
_PROBE = '[homing.z]\ndirection = "min"\nprobe = true\n'


def text(*changes, home=_PROBE):
    found = shipped_text("i3-probe").replace("noise_mm = 0.002\n", "")
    for old, new in ((_ENDSTOP, home), *changes):
        assert old in found
        found = found.replace(old, new)
    return found


def nozzle_above_bed(s):
    """The distance of the nozzle from the simulated bed below the probe, by the executed steps."""
    x, y, z = (s.positions()[axis] for axis in "xyz")
    dx, dy = s.machine.probe.offset_mm
    return z - simulated_bed(s.machine).shape.height(x + dx, y + dy)


def test_z_is_zero_on_the_bed_where_the_probe_homed():
    with Scenario(load_text(text())) as s:
        s.host.ok("G28", 60)
        x0, y0, x1, y1 = s.machine.bed_area_mm
        assert s.host.ok("M114")[0].startswith("X:150.000 Y:105.000 Z:10.000 ")
        assert ((x0 + x1) / 2, (y0 + y1) / 2) == (125.0, 110.0)
        assert nozzle_above_bed(s) == pytest.approx(10.0, abs=2 * STEP)


def test_z_is_homed_again_from_any_height_and_place():
    with Scenario(load_text(text())) as s:
        s.host.ok("G28", 60)
        s.host.ok("G1 X20 Y20 Z120 F3000", 60)
        s.host.ok("G28 Z", 90)
        assert nozzle_above_bed(s) == pytest.approx(10.0, abs=2 * STEP)
        s.host.ok("G1 Z0.2 F600", 60)
        s.host.ok("G28 X", 60)  # the head rises before it moves
        assert s.host.ok("M114")[0].startswith("X:0.000 Y:105.000 Z:10.000 ")


def test_height_of_m851_is_that_of_the_home():
    with Scenario(load_text(text())) as s:
        s.host.ok("M851 Z-2.5")
        s.host.ok("G28", 60)
        wrong = 2.5 - s.machine.probe.trigger_height_mm
        assert nozzle_above_bed(s) == pytest.approx(10.0 - wrong, abs=2 * STEP)


def test_probe_homing_works_at_any_point_and_kind():
    servo = 'kind = "servo"\ncontrol_pin = "SERVO0"\ndeploy_deg = 10.0\nstow_deg = 90.0'
    home = _PROBE + "probe_at_mm = [60.0, 50.0]\n"
    with Scenario(load_text(text(('kind = "fixed"', servo), home=home))) as s:
        s.host.ok("G28", 90)
        dx, dy = s.machine.probe.offset_mm
        assert (s.positions()["x"], s.positions()["y"]) == (60.0 - dx, 50.0 - dy)
        assert nozzle_above_bed(s) == pytest.approx(10.0, abs=2 * STEP)


def test_homing_z_alone_requires_x_and_y():
    with Scenario(load_text(text())) as s:
        (said, _) = s.host.ok("G28 Z", 60)
        assert said.startswith("echo:axis X is not homed")
        assert "z" not in s.printer.rig.positions.known


def test_probe_that_never_triggers_leaves_z_unhomed():
    stuck = ("[simulated.bed]", '[simulated.probe]\nstuck = "open"\n\n[simulated.bed]')
    with Scenario(load_text(text(stuck))) as s:
        said = s.host.ok("G28", 200)
        assert said[-2].startswith(
            "echo:Z is not homed: the probe was not triggered at X125 Y110 in a"
        )
        assert "axis Z is not homed" in s.host.ok("G1 Z20")[0]
        assert s.host.ok("G1 X20")[-1] == "ok"


@pytest.mark.parametrize(
    ("home", "message"),
    [
        (
            _PROBE + 'pin = "^Z_MIN"\n',
            "or stepper_pins with a pin for each motor, or stall, or probe = true",
        ),
        (_PROBE + "position = 0.0\n", "it is probe.trigger_height_mm, which is"),
        (_PROBE.replace('"min"', '"max"'), '"min": the probe is above the bed'),
        (_PROBE + "probe_at_mm = [1.0, 1.0]\n", "where the probe is on the bed"),
    ],
)
def test_machine_file_with_unreachable_probe_home(home, message):
    with pytest.raises(ConfigError) as caught:
        load_text(text(home=home))
    assert any(message in problem.sentence for problem in caught.value.problems)
