"""A delta finds its geometry by its probe; the nozzle is flat above the bed, by the steps."""

import re
from math import cos, dist, radians, sin

import numpy as np
import pytest
from tests.support.bed_path import BedPath
from tests.support.edited_machine import answers, at_home, edited
from tests.support.scenario import Scenario

from passo.config.load import load_text, shipped_text
from passo.errors import ConfigError
from passo.printer.setup.simulated_world import simulated_geometry

NOISE = "noise_mm = 0.01\nseed = 3"
LAYER = [
    f"G1 X{r * cos(radians(a)):.3f} Y{r * sin(radians(a)):.3f} F6000"
    for r in (15, 40, 62)
    for a in range(0, 361, 60)
]


def machine(*changes):
    return edited("delta-probe", *changes)


def homed(*changes, **options):
    return at_home(machine(*changes), **options)


def above_the_bed(s):
    """Heights of the nozzle above the flat bed, mm, in a layer at Z 0.3."""
    s.host.ok("G1 X0 Y0 Z5 F6000", 60)
    s.host.ok("G1 Z0.3", 60)
    s.host.ok("M400", 60)
    path = BedPath(s)
    for line in LAYER:
        s.host.ok(line, 60)
    s.host.ok("M400", 200)
    return path.heights(below_mm=3.0, every=40)


def rms(heights):
    return float(np.sqrt(np.mean((heights - 0.3) ** 2)))


def geometry(s):
    delta = s.printer.rig.machine
    ends = [delta.homing[name].position for name in "abc"]
    return [delta.geometry.radius, *delta.geometry.angles, *delta.geometry.rods, *ends]


def test_delta_with_a_wrong_geometry_prints_flat():
    with homed() as s:
        assert rms(above_the_bed(s)) > 0.2
        said = answers(s, "G33")
        assert re.fullmatch(r"radius: 81\.0000 -> 8[12]\.\d{4} mm", said[0])
        before, after = re.search(r"flat bed by (\S+) mm rms.*again by (\S+) mm", said[-2]).groups()
        assert float(before) > 0.3
        assert float(after) < 0.03
        heights = above_the_bed(s)
        assert len(heights) > 200
        assert rms(heights) <= 0.02
        # Homing in between changes nothing.
        s.host.ok("G28", 60)
        assert rms(above_the_bed(s)) <= 0.02


def test_delta_without_noise_finds_its_true_parameters():
    with homed((NOISE, "")) as s:
        answers(s, "G33 P4")
        true = machine().simulated.delta
        found = geometry(s)
        # The carriages stop on whole steps of 0.011 mm.
        assert found[0] == pytest.approx(true.radius, abs=0.05)
        assert found[1:4] == pytest.approx(true.angles, abs=0.05)
        assert found[4:7] == [160.0] * 3
        assert found[7:] == pytest.approx(true.endstops, abs=0.03)


def test_position_stays_true_while_the_geometry_changes():
    with homed() as s:
        answers(s, "DELTA_CALIBRATE")
        kernel = simulated_geometry(s.machine)
        q = s.positions()
        real = kernel.forward((q["a"], q["b"], q["c"]))
        assert s.printer.rig.job.machine_position[:3] == pytest.approx(real, abs=0.06)
        assert not s.printer.rig.job.locked_axes


def test_geometry_survives_restarts_bit_for_bit(tmp_path):
    state = str(tmp_path)
    with homed(state=state) as s:
        answers(s, "G33")
        answers(s, "SAVE_CONFIG")
        found = geometry(s)
        s.host.send("M112")
        s.passes(1)
        s.host.ok("M999", 60)
        assert geometry(s) == found
    with Scenario(machine(), state=state) as s:
        assert geometry(s) == found
        answers(s, "M502")
        assert geometry(s) == [81.0, 210.0, 330.0, 90.0, *[160.0] * 3, *[318.0] * 3]
        answers(s, "M501")
        assert geometry(s) == found


@pytest.mark.parametrize(
    ("limits", "says"),
    [
        ("max_radius_mm = 0.5", r"radius would change from 81\.0000 to 8\S+: at most 0\.5 mm"),
        ("max_angle_deg = 0.1", r"angle A would change .* at most 0\.1 degrees"),
        ("max_endstop_mm = 0.2", r"endstop A would change .* at most 0\.2 mm"),
    ],
)
def test_change_beyond_its_limit_leaves_the_geometry(limits, says):
    with homed(("[simulated.bed]", f"[levelling.delta]\n{limits}\n[simulated.bed]")) as s:
        before = geometry(s)
        assert re.search(says, answers(s, "G33")[-1])
        assert geometry(s) == before


def test_result_that_is_worse_when_measured_again_is_taken_back():
    with homed() as s:
        answers(s, "G33")
        before, prober = geometry(s), s.printer.motion.prober
        measure, runs = prober.measure, []

        async def measured(places):
            found = await measure(places)
            runs.append(geometry(s)[0])
            s.board.spoil_probe(noise_mm=0.3)
            return found

        prober.measure = measured
        assert re.search(r"\d\.\d+ mm rms, before it 0\.\d+ mm", answers(s, "G33")[-1])
        assert runs[0] == before[0] != runs[1]
        assert geometry(s) == before


def test_failed_run_leaves_the_geometry():
    with homed() as s:
        before = geometry(s)
        s.board.spoil_probe(dead_areas=[(-5, 40, 5, 60)])
        assert re.search("^echo:Point 2 was not measured", answers(s, "G33")[-1])
        assert geometry(s) == before


def test_m665_and_m666_speak_marlin():
    with homed() as s:
        assert answers(s, "M665") == [
            "  M665 L160.0000 R81.0000 H180.0181 X0.0000 Y0.0000 Z0.0000 A0.0000 B0.0000 C0.0000"
        ]
        answers(s, "M665 L161 B0.2 R82 X0.5 H180")
        assert geometry(s)[:7] == [82.0, 210.5, 330.0, 90.0, 161.0, 161.2, 161.0]
        answers(s, "M666 Y-0.4")
        assert answers(s, "M666") == ["  M666 X0.0000 Y-0.4000 Z0.0000 ; Marlin's signs"]
        # The nozzle is at H in the middle if all towers are like the lowest one.
        ends = geometry(s)[7:]
        assert ends[0] - (161**2 - 82**2) ** 0.5 == pytest.approx(180, abs=1e-6)
        assert ends[1] - (161.2**2 - 82**2) ** 0.5 == pytest.approx(180.4, abs=1e-6)
        assert "X is 0.1: expected -50 to 0" in answers(s, "M666 X0.1")[0]
        assert (
            "the shortest rod is 80 mm: expected more than the radius" in answers(s, "M665 L80")[0]
        )
        assert "needs L" in answers(s, "M665 A1")[0]


def test_m666_has_reprap_signs_if_the_machine_file_sets_it():
    with homed(("[simulated.bed]", '[levelling]\ndialect = "rrf"\n[simulated.bed]')) as s:
        answers(s, "M666 X-0.1 Y0.3 Z-0.2")
        assert answers(s, "M666") == ["  M666 X-0.1000 Y0.3000 Z-0.2000 ; RepRapFirmware's signs"]
        assert geometry(s)[7:] == pytest.approx([317.9, 318.3, 317.8], abs=1e-6)


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("G33 P1", "P is 1: expected 3 to 10"),
        ("G33 F9", "F is 9: expected 6 or 7"),
        ("G33 R90", "R is 90: expected more than 0, at most 61.1"),
        ("SET_DELTA RADIUS=nan", "'RADIUS=nan' has no valid number"),
        ("SET_DELTA ROD_A=0", "ROD_A is 0: expected 1 to 10,000 mm"),
    ],
)
def test_words_that_make_no_sense_are_refused(line, says):
    with homed() as s:
        assert says in answers(s, line)[0]


def test_delta_must_be_homed_before_it_is_calibrated():
    with Scenario(machine()) as s:
        assert "is not homed" in answers(s, "G33")[0]


def test_true_geometry_of_another_kind_is_refused():
    with pytest.raises(ConfigError, match=r"simulated.delta is .cartesian.: .* kind .delta."):
        load_text(shipped_text("i3-probe") + "\n[simulated.delta]\nradius = 80.0\n")


def measured_part(s):
    """The words of DELTA_ANALYZE for Klipper's calibration part, printed with the geometry in
    force: marks are where the true machine has put the nozzle."""
    now, true = s.printer.rig.machine, simulated_geometry(s.machine)
    ends = [now.homing[name].position for name in "abc"]
    below = [b - a for a, b in zip(ends, s.machine.simulated.delta.endstops, strict=True)]

    def there(x, y):
        carriages = now.geometry.inverse((x, y, 0.0))
        return true.forward(tuple(q + mm for q, mm in zip(carriages, below, strict=True)))

    def towards(k, mm, x=0.0, y=0.0):
        angle = radians((210, 270, 330, 30, 90, 150)[k % 6])
        return x + mm * cos(angle), y + mm * sin(angle)

    def length(k, x=0.0, y=0.0):
        return dist(there(*towards(k, 4.5, x, y)), there(*towards(k, 69.5, x, y)))

    center = ",".join(f"{length(k) + 9:.4f}" for k in range(6))
    outer = ",".join(f"{length(k + 2, *towards(k, 65.0)) + 9:.4f}" for k in range(6))
    return (
        f"CENTER_DISTS={center} CENTER_PILLAR_WIDTHS=9,9,9",
        f"OUTER_DISTS={outer} OUTER_PILLAR_WIDTHS=9,9,9,9,9,9",
    )


def with_paper(s):
    """Lowers the nozzle to the bed at each point of a paper test, as a user does; returns the last
    answer."""
    kernel = simulated_geometry(s.machine)
    said = []
    while s.printer.levelling.manual_probe.status is not None:
        q = s.positions()
        z = kernel.forward((q["a"], q["b"], q["c"]))[2]
        answers(s, f"TESTZ Z={-z:.4f}")
        said = answers(s, "ACCEPT")
    return said


def without_probe(*changes):
    """The delta with a wrong geometry, without its probe."""
    text = shipped_text("delta-probe")
    for old, new in ((NOISE, ""), *changes):
        assert old in text
        text = text.replace(old, new)
    probe = text.index("[probe]")
    return load_text(text[:probe] + text[text.index("\n[", probe) :])


RODS = ("angles = [210.4", "rods = [160.5, 159.7, 160.2]\nangles = [210.4")


@pytest.mark.parametrize("way", ["probe", "manual", "points of before"])
def test_lengths_of_a_printed_part_find_the_rods(way):
    with at_home(machine((NOISE, ""), RODS) if way == "probe" else without_probe(RODS)) as s:
        if way == "points of before":
            answers(s, "DELTA_CALIBRATE")
            assert "Calibrated 6 factors using 7 points" in with_paper(s)[-2]
        first, second = measured_part(s)
        (left,) = answers(s, f"DELTA_ANALYZE {first}")
        assert left == "// Still to measure: OUTER_DISTS, OUTER_PILLAR_WIDTHS"
        method = " METHOD=manual" if way == "manual" else ""
        said = answers(s, f"DELTA_ANALYZE {second} CALIBRATE=extended{method}")
        said = with_paper(s) or said
        assert "Calibrated 9 factors using 7 points and 12 distances" in said[-2]
        # Heights are whole steps of 0.011 mm.
        assert geometry(s)[4:7] == pytest.approx([160.5, 159.7, 160.2], abs=0.1)
        assert geometry(s)[0] == pytest.approx(82.1, abs=0.1)


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("CENTER_DISTS=1,2,3", "CENTER_DISTS is 1,2,3: expected 6 lengths in mm"),
        ("CALIBRATE=extended", "needs CENTER_DISTS"),
        ("CALIBRATE=short", "CALIBRATE is short: expected extended"),
    ],
)
def test_rods_are_not_sought_without_all_lengths(line, says):
    with Scenario(machine()) as s:
        assert says in answers(s, f"DELTA_ANALYZE {line}")[0]


@pytest.mark.parametrize("line", ["DELTA_CALIBRATE", "DELTA_CALIBRATE METHOD=manual"])
def test_delta_is_calibrated_by_the_paper_test(line):
    with at_home(without_probe() if line == "DELTA_CALIBRATE" else machine()) as s:
        answers(s, line)
        said = with_paper(s)
        before, after = re.search(r"flat bed by (\S+) mm rms.*again by (\S+) mm", said[-2]).groups()
        assert float(before) > 0.3
        assert float(after) < 0.02
        assert rms(above_the_bed(s)) <= 0.02


def test_manual_height_is_one_more_point():
    with at_home(without_probe()) as s:
        s.host.ok("G1 X30 Y-20 Z4 F6000", 60)
        s.host.ok("M400", 60)
        q = s.positions()
        z = simulated_geometry(s.machine).forward((q["a"], q["b"], q["c"]))[2]
        (said,) = answers(s, f"DELTA_ANALYZE MANUAL_HEIGHT={z:.4f}")
        assert said.startswith("// Manual height: X30.000 Y-20.000 Z4.000 is ")
        assert "expected -10 to 10" in answers(s, "DELTA_ANALYZE MANUAL_HEIGHT=11")[0]
        answers(s, "DELTA_CALIBRATE")
        said = with_paper(s)[-2]
        assert "Calibrated 6 factors using 8 points" in said
        assert float(re.search(r"again by (\S+) mm", said)[1]) < 0.02
        s.host.ok("G1 X30 Y-20 Z4 F6000", 60)
        s.host.ok("M400", 60)
        q = s.positions()
        z = simulated_geometry(s.machine).forward((q["a"], q["b"], q["c"]))[2]
        assert z == pytest.approx(4, abs=0.03)


def test_too_large_a_change_by_hand_leaves_the_geometry():
    limits = "[levelling.delta]\nmax_radius_mm = 0.5\n[simulated.bed]"
    with at_home(without_probe(("[simulated.bed]", limits))) as s:
        before = geometry(s)
        answers(s, "DELTA_CALIBRATE")
        assert "radius would change from 81.0000" in with_paper(s)[-1]
        assert geometry(s) == before
