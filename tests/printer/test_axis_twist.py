"""The correction of measured heights along a twisted axis."""

import pytest
from tests.support.edited_machine import STILL, answers, at_home, edited

from passo.config.load import load_text, shipped_text
from passo.errors import ConfigError
from passo.printer.setup.simulated_world import simulated_bed

STEP = 1 / 400
PLACES = "\n[probe.twist.x]\nfrom_mm = 30\nto_mm = 190\nacross_mm = 110\n"


def machine(heights=()):
    written = f"heights_mm = {list(heights)}\n" if heights else ""
    return edited("i3-probe", STILL, more=PLACES + written)


def height(s, x, y):
    return float(answers(s, f"G30 X{x} Y{y}")[-1].split()[-1])


@pytest.mark.parametrize(
    ("x", "added"), [(30, 0.1), (70, 0.05), (110, 0.0), (150, 0.1), (190, 0.2), (206, 0.24)]
)
def test_heights_are_corrected_linearly_between_the_places(x, added):
    with at_home(machine([0.1, 0.0, 0.2])) as s:
        bed = simulated_bed(s.machine).shape
        assert height(s, x, 110) == pytest.approx(bed.height(x, 110) + added, abs=STEP + 5e-4)


def test_calibration_by_paper_finds_the_twist_and_m500_keeps_it(tmp_path):
    with at_home(machine(), state=str(tmp_path)) as s:
        s.host.ok("AXIS_TWIST_COMPENSATION_CALIBRATE SAMPLE_COUNT=3", 120)
        bed, twist = simulated_bed(s.machine).shape, (0.05, -0.02, 0.0)
        for x, mm in zip((30, 110, 190), twist, strict=True):
            # the probe triggers `mm` too high here, so the paper moves that much lower
            down = bed.height(x, 110) - mm - s.positions()["z"]
            s.host.ok(f"TESTZ Z={down:.4f}")
            said = answers(s, "ACCEPT")
        assert said[-1].startswith("// SET_AXIS_TWIST AXIS=X HEIGHTS=")
        found = s.printer.motion.prober.twist["x"].heights_mm
        mean = sum(twist) / 3
        assert found == pytest.approx([mean - mm for mm in twist], abs=2 * STEP)
        s.host.ok("M500")
    with at_home(machine(), state=str(tmp_path)) as s:
        assert s.printer.motion.prober.twist["x"].heights_mm == pytest.approx(found, abs=1e-6)
        bed = simulated_bed(s.machine).shape
        assert height(s, 30, 110) == pytest.approx(bed.height(30, 110) + found[0], abs=2 * STEP)


def test_home_by_the_probe_counts_the_twist_at_its_place():
    _home = '[homing.z]\ndirection = "min"\nprobe = true\n'
    old = shipped_text("i3-probe")
    start = old.index("[homing.z]")
    end = old.index("\n[", start + 1) + 1
    text = (old[:start] + _home + "\n" + old[end:]).replace(*STILL)
    with at_home(load_text(text + PLACES + "heights_mm = [0.3, 0.3]\n")) as s:
        bed, z = simulated_bed(s.machine).shape, s.positions()["z"]
        dx, dy = s.machine.probe.offset_mm
        x, y = s.positions()["x"] + dx, s.positions()["y"] + dy
        # the heights are 0.3 mm more than the probe tells, so Z 0 is 0.3 mm higher
        assert z - bed.height(x, y) == pytest.approx(10.0 + 0.3, abs=3 * STEP)


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("SET_AXIS_TWIST HEIGHTS=1", "HEIGHTS is 1: expected 2 to 100 numbers of -5 to 5"),
        ("SET_AXIS_TWIST HEIGHTS=0,9", "expected 2 to 100 numbers of -5 to 5"),
        (
            "SET_AXIS_TWIST AXIS=Y HEIGHTS=0,1",
            "needs [probe.twist.y], which the machine file",
        ),
        ("AXIS_TWIST_COMPENSATION_CALIBRATE AXIS=Y", "Give the places there: from_mm, to_mm"),
    ],
)
def test_wrong_twist_is_refused_and_changes_nothing(line, says):
    with at_home(machine([0.1, 0.2])) as s:
        assert says in answers(s, line)[-1]
        assert s.printer.motion.prober.twist["x"].heights_mm == [0.1, 0.2]


def test_twist_of_one_height_or_place_is_refused():
    for key in ("heights_mm = [0.1]\n", "to_mm = 30\n"):
        places = PLACES.replace("to_mm = 190\n", "") if "to_mm" in key else PLACES
        with pytest.raises(ConfigError, match=r"at least two|another place than from_mm"):
            load_text(shipped_text("i3-probe") + places + key)
