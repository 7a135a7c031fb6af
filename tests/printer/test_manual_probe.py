"""The paper test, and the height at which the probe triggers."""

import re

import pytest
from tests.support.edited_machine import STILL, answers, at_home, edited
from tests.support.scenario import Scenario

from passo.printer.setup.simulated_world import simulated_bed

STEP = 1 / 400
PROBE = 'kind = "fixed"\npin = "^Z_MAX"\noffset_mm = [-25.0, 5.0]\ntrigger_height_mm = 1.2'


def machine(*changes):
    return edited("i3-probe", STILL, *changes)


def homed(*changes, **options):
    return at_home(machine(*changes), **options)


def lower_to_the_bed(s):
    """As a user does with a sheet of paper."""
    p = s.positions()
    gap = p["z"] - simulated_bed(s.machine).shape.height(p["x"], p["y"])
    return answers(s, f"TESTZ Z={-gap:.4f}")


@pytest.mark.parametrize(("method", "count"), [("mesh", 6), ("linear", 9)])
@pytest.mark.parametrize("line", ["G29", "G32"])
def test_bed_is_levelled_with_a_sheet_of_paper(method, count, line):
    changes = (PROBE, 'kind = "manual"'), ('"quadratic"', f'"{method}"'), ("[5, 5]", "[3, 2]")
    with homed(*changes) as s:
        said = answers(s, line)
        assert said[0] == f"echo:Manual probing point 1 of {count}, at X15 Y15"
        for n in range(count):
            assert s.printer.levelling.bed.status().manual.number == n + 1
            lower_to_the_bed(s)
            said = answers(s, "G29 S2" if n % 2 else "ACCEPT")
        assert s.printer.levelling.bed.status().manual is None
        correction = s.printer.motion.correction
        assert correction.on
        bed = simulated_bed(s.machine).shape
        # The plane leaves the dome.
        within = STEP if method == "mesh" else 0.08
        assert correction.expected(15, 15) == pytest.approx(bed.height(15, 15), abs=within)


def test_paper_test_narrows_the_height_down():
    with homed() as s:
        answers(s, "G1 X100 Y100 Z10 F6000")
        assert answers(s, "MANUAL_PROBE")[-1] == "// Z position: ?????? --> 10.000 <-- ??????"
        assert answers(s, "TESTZ Z=-9") == ["// Z position: ?????? --> 1.000 <-- 10.000"]
        assert answers(s, "TESTZ Z=-.5") == ["// Z position: ?????? --> 0.500 <-- 1.000"]
        assert answers(s, "TESTZ Z=+") == ["// Z position: 0.500 --> 0.750 <-- 1.000"]
        assert answers(s, "TESTZ Z=--") == ["// Z position: ?????? --> 0.500 <-- 0.750"]
        assert s.positions()["z"] == 0.5
        assert "no height was tried there yet" in answers(s, "TESTZ Z=-")[0]
        assert re.search(r"Z is -2\.500: expected Z -2\.000 to", answers(s, "TESTZ Z=-3")[0])
        assert "a paper test is under way" in answers(s, "PROBE_CALIBRATE")[0]
        status = s.printer.levelling.bed.status().manual
        assert (status.z_mm, status.below_mm, status.above_mm) == (0.5, None, 0.75)
        assert answers(s, "ACCEPT") == ["// Z position is 0.500"]
        assert s.positions()["z"] == 10.0
        assert "no paper test is under way" in answers(s, "TESTZ Z=1")[0]


def test_trigger_height_is_found_by_the_paper_test(tmp_path):
    with homed(("= 1.2", "= 2.0"), state=str(tmp_path)) as s:
        # The simulated probe triggers at 2.0; the machine is told something else.
        answers(s, "M851 Z-1.5")
        answers(s, "G1 X135 Y105 Z5 F6000")
        answers(s, "PROBE_CALIBRATE")
        assert s.positions()["x"] == 110.0
        assert s.positions()["y"] == 110.0
        lower_to_the_bed(s)
        found = float(answers(s, "ACCEPT")[0].removeprefix("// probe: z_offset: "))
        assert found == pytest.approx(2.0, abs=1.2 * STEP)
        height = s.printer.motion.prober.trigger_height_mm
        assert height == pytest.approx(found, abs=5e-4)
        answers(s, "M500")
    with Scenario(machine(("= 1.2", "= 2.1")), state=str(tmp_path)) as s:
        assert s.printer.motion.prober.trigger_height_mm == height


def test_end_of_a_paper_test_changes_nothing():
    with homed() as s:
        answers(s, "G32")
        before = s.printer.motion.correction.correction
        answers(s, "MANUAL_PROBE")
        # Z is that of the machine meanwhile.
        assert s.printer.rig.job.machine_position[2] == pytest.approx(10.0)
        assert answers(s, "ABORT") == ["// Manual probe aborted"]
        assert s.printer.motion.correction.correction is before
        x, y, z, *_ = s.printer.rig.job.machine_position
        assert z == pytest.approx(10 - before.plain(x, y))


def test_halt_ends_the_paper_test():
    with homed() as s:
        answers(s, "MANUAL_PROBE")
        s.host.send("M112")
        s.passes(1)
        s.host.ok("M999", 60)
        s.passes(1)
        assert "no paper test is under way" in answers(s, "ACCEPT")[0]


@pytest.mark.parametrize(
    "line", ["G30", "M48", "QUERY_PROBE", "M401", "PROBE_CALIBRATE", "G38.2 Z0"]
)
def test_paper_measures_nothing_by_itself(line):
    with homed((PROBE, 'kind = "manual"')) as s:
        before = s.positions()
        assert "a sheet of paper, which measures nothing by itself" in answers(s, line)[-1]
        assert s.positions() == before
        assert "z_probe" not in " ".join(s.host.ok("M119"))


def test_whole_mesh_of_the_paper_test_is_raised_to_a_height():
    with homed((PROBE, 'kind = "manual"'), ('"quadratic"', '"mesh"'), ("[5, 5]", "[2, 2]")) as s:
        answers(s, "G29 S1")
        for _ in range(4):
            lower_to_the_bed(s)
            answers(s, "G29 S2")
        before = s.printer.motion.correction.correction.mesh.heights
        answers(s, "G29 S4 Z0.2")
        answers(s, "M420 S1")
        (said,) = answers(s, "G29 S4 Z0.1")
        assert said == "echo:The mesh is 0.100 mm higher than it was measured"
        after = s.printer.motion.correction.correction.mesh.heights
        assert after == tuple(tuple(pytest.approx(z + 0.1) for z in row) for row in before)
        assert "needs Z" in answers(s, "G29 S4")[0]
