"""Z_OFFSET_APPLY_PROBE and Z_OFFSET_APPLY_ENDSTOP: babysteps become a stored offset, once, and
nothing moves."""

from pathlib import Path

import pytest
from tests.support.edited_machine import STILL, Change, answers, at_home, edited

from passo.config import load
from passo.levelling.correction import Correction

STEP = 1 / 400
MESH: Change = ('method = "quadratic"', 'method = "mesh"')
HOMED_BY_PROBE: Change = (
    '[homing.z]\ndirection = "min"\nposition = 0.0\npin = "^Z_MIN"\n',
    '[homing.z]\ndirection = "min"\nprobe = true\n',
)
SQUARE = "G1 X130\nG1 Y90\nG1 X80\nG1 Y60\n"  # as slicers write a layer: no move names Z


def homed(*changes: Change, **options: str):
    return at_home(edited("i3-probe", STILL, *changes), **options)


def height(s) -> float:
    return s.positions()["z"]


def sends(s, *lines: str) -> None:
    for line in (*lines, "M400"):
        answers(s, line)


@pytest.mark.parametrize("mm", [-0.2, 0.15])
@pytest.mark.parametrize(
    ("changes", "measure", "fade"),
    [
        ((), "G32", "M420 Z0"),
        ((), "G32", "M420 Z10"),
        ((MESH,), "G29", "M420 Z10"),
        ((HOMED_BY_PROBE,), "M420 S0", "M420 Z0"),
        ((HOMED_BY_PROBE, MESH), "G29", "M420 Z10"),
    ],
)
def test_nothing_moves_and_z_reads_the_same(changes, measure, fade, mm):
    slack = 1.1 * STEP if fade == "M420 Z10" else 1e-9
    with homed(*changes) as s:
        sends(s, measure, fade, "G1 X100 Y100 Z5 F6000", "G92 Z5.5", f"M290 Z{mm}")
        before = height(s)
        assert answers(s, "Z_OFFSET_APPLY_PROBE")[0] == f"// z_offset: 1.200 -> {1.2 - mm:.3f}"
        assert s.printer.rig.job.program_position[2] == pytest.approx(5.5, abs=1e-9)
        assert s.printer.motion.offsets.babysteps_mm["z"] == 0
        sends(s, "G91", "G1 X10", "G1 X-10", "G90")
        assert height(s) == before
        sends(s, "G1 Z1", "G1 Z5.5")
        # A correction fades by the Z of the machine, which is another one now.
        assert height(s) == pytest.approx(before, abs=slack)
        sends(s, "G28", "G1 X100 Y100 Z5")
        assert height(s) == pytest.approx(before, abs=1.1 * STEP)  # counted once
        assert answers(s, "Z_OFFSET_APPLY_PROBE") == ["// Nothing to do: Z Offset is 0"]


def printing(tmp_path: Path, measure: str, *changes: Change):
    """A print in its first layer of 0.3 mm, with babysteps of 0.1 mm."""
    lines = f"G28\n{measure}\nG1 X60 Y60 Z0.3 F1200\n" + SQUARE * 8
    (tmp_path / "a.g").write_text(lines)
    s = homed(*changes, card=str(tmp_path))
    s.host.ok("M32 a.g")
    assert s.until(lambda: s.printer.rig.job.program_position[2] == 0.3, 200)
    s.passes(12)
    s.host.ok("M290 Z0.1")
    s.passes(3)
    return s


def above_bed(s, bed) -> float:
    """The nozzle above a corrected bed, by the mechanics."""
    at = s.positions()
    return at["z"] - bed.plain(at["x"], at["y"])


@pytest.mark.parametrize("changes", [(), (HOMED_BY_PROBE,)])
def test_layer_without_z_stays_at_its_height(tmp_path, changes):
    with printing(tmp_path, "G32", *changes) as s:
        bed = s.printer.motion.correction.correction
        before = above_bed(s, bed)
        s.host.ok("Z_OFFSET_APPLY_PROBE", 60)
        for _ in range(8):
            s.passes(1)
            assert above_bed(s, bed) == pytest.approx(before, abs=1.1 * STEP)
        s.host.expect("Done printing", 200)
        assert s.printer.rig.job.program_position[2] == pytest.approx(0.3, abs=1e-9)


@pytest.mark.parametrize(
    ("measure", "changes", "line"),
    [
        ("G32", (), "Z_OFFSET_APPLY_PROBE"),
        ("G32", (HOMED_BY_PROBE,), "Z_OFFSET_APPLY_PROBE"),
        ("M420 S0", (), "Z_OFFSET_APPLY_ENDSTOP"),
    ],
)
def test_paused_print_returns_to_where_it_was(tmp_path, measure, changes, line):
    with printing(tmp_path, measure, *changes) as s:
        bed = s.printer.motion.correction.correction or Correction()
        before = above_bed(s, bed)
        s.host.ok("M25", 60)
        s.passes(30)
        assert above_bed(s, bed) > before + 1  # parked
        s.host.ok(line, 60)
        s.host.ok("M24", 60)
        s.passes(4)
        for _ in range(8):
            s.passes(1)
            assert above_bed(s, bed) == pytest.approx(before, abs=1.1 * STEP)
        s.host.expect("Done printing", 200)
        assert s.printer.rig.job.program_position[2] == pytest.approx(0.3, abs=1e-9)


def test_babysteps_become_the_home_offset_once():
    with at_home(load("i3")) as s:
        sends(s, "G1 Z5 F600", "G92 Z6", "M290 Z-0.1")
        before = height(s)
        said = answers(s, "Z_OFFSET_APPLY_ENDSTOP")
        assert said == ["// M206 Z: 0.000 -> 0.100. M500 or SAVE_CONFIG stores it"]
        sends(s, "G1 Z8", "G1 Z6")
        assert height(s) == before == pytest.approx(4.9)
        sends(s, "G28", "G1 Z5")
        assert height(s) == before
        assert answers(s, "Z_OFFSET_APPLY_ENDSTOP") == ["// Nothing to do: Z Offset is 0"]


def test_trigger_height_counts_at_once_and_once():
    with homed(HOMED_BY_PROBE, MESH) as s:
        sends(s, "G29", "G1 X100 Y100 Z5 F6000")
        before = height(s)
        sends(s, "M851 Z-1.4")
        assert height(s) == before
        assert s.printer.rig.job.program_position[2] == pytest.approx(5.2, abs=1e-9)
        sends(s, "G28", "G1 X100 Y100 Z5.2")
        assert height(s) == pytest.approx(before, abs=STEP)


def test_refused_offset_changes_nothing():
    with homed() as s:
        sends(s, "M290 Z0.1")
        said = answers(s, "Z_OFFSET_APPLY_PROBE")[0]
        assert "the 0.100 mm of babysteps are not an offset of the probe" in said
        sends(s, "G32", "G1 X100 Y100 Z5", "M290 Z1.9", "M290 Z1")
        before = height(s)
        assert "would be corrected by 3.326 mm" in answers(s, "Z_OFFSET_APPLY_PROBE")[0]
        assert height(s) == before
        assert s.printer.motion.prober.trigger_height_mm == 1.2
        assert s.printer.motion.offsets.babysteps_mm["z"] == pytest.approx(3.0)
