"""The probe measures the simulated bed, or says why it did not."""

import re
from array import array
from functools import partial

import pytest
from tests.support.edited_machine import STILL, answers, at_home, edited
from tests.support.scenario import Scenario

from passo.printer.setup.connections import connect_simulated
from passo.printer.setup.simulated_world import simulated_bed
from passo.simulator import Cable

STEP = 1 / 400
ON_TOOL = '"^Z_MAX"', '"^tool:Z_MAX"'
POINTS = [(15, 15), (215, 15), (110, 110), (60.5, 170.25)]


def machine(*changes, more=""):
    return edited("i3-probe", STILL, *changes, more=more)


def homed(*changes, **options):
    return at_home(machine(*changes), **options)


def probed(s, x, y):
    """The height that G30 reports."""
    said = s.host.ok(f"G30 X{x} Y{y}", 60)
    (line,) = [line for line in said if line.startswith("Bed X:")]
    assert line.startswith(f"Bed X: {x:.2f} Y: {y:.2f} Z: ")
    return float(line.split()[-1])


def refusal(s, line="G30 X110 Y110"):
    """What G30 answers instead of a height."""
    (text,) = answers(s, line)
    return text


def lowest(s, line):
    """The lowest Z of the nozzle, in mm, while a line is carried out, from the executed steps."""
    now = s.printer.rig.connection.now
    before = s.board.position("z")
    s.board.trace_steps("z", now, 1 << 60)
    said = s.host.ok(line, 120)
    directions = array("b", s.board.take_steps("z", 0, 1 << 60)[1])
    at = low = round(before / STEP)
    for direction in directions:
        at += direction
        low = min(low, at)
    return low * STEP, said


def test_probe_measures_the_bed_to_one_step():
    with homed() as s:
        bed = simulated_bed(s.machine).shape
        for x, y in POINTS:
            # G30 reports whole micrometres.
            assert probed(s, x, y) == pytest.approx(bed.height(x, y), abs=STEP + 5e-4)
        assert s.positions() == {"x": 85.5, "y": 165.25, "z": 10.0, "e": 0.0}
        assert s.host.ok("M114")[0].startswith("X:85.500 Y:165.250 Z:10.000 ")


def test_probe_and_motor_may_be_on_two_boards(monkeypatch):
    cable = Cable(5e-3, 1e-3)
    monkeypatch.setattr("passo.printer.printer.connect", partial(connect_simulated, cable=cable))
    tool = '[boards.tool]\nbase = "ramps"\ndrift_ppm = 100.0\nstart_s = 77.0\n'
    with at_home(machine(ON_TOOL, more=tool)) as s:
        bed = simulated_bed(s.machine).shape
        for x, y in POINTS:
            assert probed(s, x, y) == pytest.approx(bed.height(x, y), abs=STEP + 5e-4)
        s.host.ok("G1 X50 Y50 Z5 F6000", 60)
        s.host.ok("M400", 60)
        assert s.positions()["z"] == pytest.approx(5, abs=STEP)


def test_delta_probes_and_reports_its_carriages():
    pin = '[probe]\nkind = "fixed"\npin = "^E0_STOP"\ntrigger_height_mm = 0.0\n'
    pin += "[simulated.bed]\ntilt_mm = [0.3, 0.2]\n"
    with at_home(edited("delta", more=pin)) as s:
        bed = simulated_bed(s.machine).shape
        for x, y in [(0, 0), (40, 20), (-30, -35)]:
            assert probed(s, x, y) == pytest.approx(bed.height(x, y), abs=1.5 / 87 + 5e-4)
        s.host.ok("G1 X10 Y5 Z20 F6000", 60)
        s.host.ok("M400", 60)
        for name, at in zip("abc", s.machine.geometry.inverse((10, 5, 20)), strict=True):
            assert s.positions()[name] == pytest.approx(at, abs=1.01 / 87)


def test_probe_needs_all_axes_homed():
    with Scenario(machine()) as s:
        s.host.ok("G28 X Y", 60)
        assert "axis Z is not homed" in refusal(s)
        assert s.positions()["z"] == 20.0


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("G30 X249 Y15", r"nozzle is at X274 Y10 Z10, and X goes from 0 to 250"),
        ("G30 X-1 Y15", r"the bed goes from X0 Y0 to X250 Y220"),
    ],
)
def test_point_out_of_reach_moves_nothing(line, says):
    with homed() as s:
        before = s.positions()
        assert re.search(says, refusal(s, line))
        assert s.positions() == before


def fault(s, **faults):
    s.board.spoil_probe(**faults)


def test_probe_stuck_open_stops_at_the_low_point():
    with homed() as s:
        s.host.ok("M104 S210")
        s.board.force_switch("probe", False)
        low, said = lowest(s, "G30 X110 Y110")
        assert low == pytest.approx(-2.0, abs=STEP)
        text = said[-2]
        assert "the probe was not triggered at X110 Y110. The nozzle descended to" in text
        assert "to X135.000 Y105.000 Z-2.000, and the search ends at Z -2 mm" in text
        assert s.positions()["z"] == 10.0
        assert s.printer.rig.job.locked_axes == []
        assert s.printer.rig.connection.heaters["hotend"].target == 210
        s.board.force_switch("probe", None)
        assert probed(s, 110, 110) == pytest.approx(0.1249, abs=0.01)


def test_descent_ends_at_the_limit_of_the_motor():
    limit = "[steppers.z]\nmin_mm = -0.5\nmax_mm = 260.0"
    with homed(("[steppers.z]", limit)) as s:
        s.board.force_switch("probe", False)
        low, said = lowest(s, "G30 X110 Y110")
        assert low == pytest.approx(-0.5, abs=STEP)
        assert "search ends at Z -0.5 mm" in said[-2]


def test_probe_stuck_triggered_never_descends():
    with homed() as s:
        s.board.force_switch("probe", True)
        low, said = lowest(s, "G30 X110 Y110")
        assert low == 0.0  # of G28
        assert "the probe is triggered at X110 Y110 with the nozzle at X135.000" in said[-2]
        assert "also after a lift by 3 mm" in said[-2]
        assert s.printer.rig.job.locked_axes == []


def test_probe_that_triggers_in_the_air_is_refused():
    with homed() as s:
        x, y = 135.0, 105.0
        s.board.spoil_probe(touchy_areas=[(x - 1, y - 1, x + 1, y + 1)])
        low, said = lowest(s, "G30 X110 Y110")
        assert low == 0.0
        assert "is triggered at X110 Y110" in said[-2]


def test_probe_triggered_for_a_moment_in_a_descent_is_refused():
    with homed() as s:
        s.host.ok("G1 Z10 F600", 60)
        s.host.ok("M400", 60)
        s.host.send("G30 X110 Y110")
        assert s.until(lambda: s.positions()["x"] == 135 and s.positions()["z"] < 9.9, 20)
        s.board.force_switch("probe", True)
        s.host.expect("the probe was triggered at X110 Y110 with the nozzle at .* less than 1 mm")
        s.host.expect("^ok")


def test_hysteresis_is_overcome_by_further_lifts():
    faulty = "[simulated.probe]\nhysteresis_mm = 3.2\n\n[heaters.hotend]"
    with homed(("[heaters.hotend]", faulty)) as s:
        assert probed(s, 110, 110) == pytest.approx(0.1249, abs=0.01)
    faulty = faulty.replace("3.2", "9.0")
    with homed(("[heaters.hotend]", faulty)) as s:
        assert "also after a lift by 3 mm" in refusal(s)


def test_noisy_samples_are_dropped_and_then_refused():
    change = ("trigger_height_mm = 1.2", "trigger_height_mm = 1.2\nsamples = 5")
    with homed(change) as s:
        s.board.spoil_probe(noise_mm=0.2)
        text = refusal(s)
        assert re.search(r"at X110 Y110 the samples differ by 0\.\d+ mm \(limit 0\.05 mm\)", text)
        assert s.printer.rig.job.locked_axes == []
        s.board.spoil_probe(noise_mm=0.004)
        assert probed(s, 110, 110) == pytest.approx(0.1249, abs=0.01)


def test_descents_that_differ_by_more_than_1_mm_are_refused_at_once():
    with homed() as s:
        s.host.send("G30 X110 Y110")
        assert s.until(lambda: s.positions()["x"] == 135 and s.positions()["z"] < 1.4, 30)
        assert s.until(lambda: s.positions()["z"] > 2, 30)  # after the first descent
        s.board.tilt_bed(20.0)  # 1.2 mm lower there
        s.host.expect(r"at X110 Y110 two descents differ by 1\.\d+ mm \(limit 1 mm\)", 30)
        s.host.expect("^ok", 30)
        assert s.positions()["z"] == 10.0


def test_lost_board_of_the_probe_stops_the_descent(monkeypatch):
    cable = Cable(1e-4, 0.0)
    monkeypatch.setattr("passo.printer.printer.connect", partial(connect_simulated, cable=cable))
    with at_home(machine(ON_TOOL, more='[boards.tool]\nbase = "ramps"\n')) as s:
        s.host.send("G30 X110 Y110")
        assert s.until(lambda: s.positions()["x"] == 135 and s.positions()["z"] < 8, 30)
        s.printer.board.cut_cable("tool")
        s.passes(0.1)
        stopped = s.positions()["z"]
        assert 8 - 5 * 0.08 < stopped < 8
        s.printer.board.cut_cable("tool", False)
        s.host.expect("the boards of the probe .*lost their connection|does not answer", 10)


def test_heaters_are_off_only_during_a_descent():
    change = ("trigger_height_mm = 1.2", 'trigger_height_mm = 1.2\nheaters_off = ["bed"]')
    with homed(change) as s:
        s.host.ok("M140 S60")
        bed = s.printer.rig.connection.heaters["bed"]
        s.host.send("G30 X110 Y110")
        seen = []
        done = len(s.host.heard)

        def look():
            seen.append((s.positions()["z"], bed.power))
            assert bed.target == 60.0 or not bed.suspended
            return "ok" in s.host.heard[done:]

        assert s.until(look, 60)
        assert s.positions()["z"] == 10.0
        assert {power > 0 for z, power in seen if 0.1 < z < 3.2} == {False, True}
        assert 0.0 in {power for z, power in seen if 4 < z < 9}
        assert s.until(lambda: bed.power > 0, 10)


def test_heaters_stay_on_in_a_descent_of_more_than_20_s():
    slow = 'trigger_height_mm = 1.2\nslow_mm_s = 0.2\nheaters_off = ["bed"]'
    with homed(("trigger_height_mm = 1.2", slow)) as s:
        s.host.ok("M140 S60")
        bed, looks_off = s.printer.rig.connection.heaters["bed"], []
        del s.host.heard[:]
        s.host.send("G30 X110 Y110")

        def look():
            looks_off.append(bed.suspended)
            return "ok" in s.host.heard

        assert s.until(look, 120)
        # 100 looks a second: off in the fast descent, on in the slow one, which takes 10 s.
        assert 100 < sum(looks_off) < 400
        assert len(looks_off) > 1000


def test_heater_switched_off_during_a_descent_stays_off():
    change = ("trigger_height_mm = 1.2", 'trigger_height_mm = 1.2\nheaters_off = ["bed"]')
    with homed(change) as s:
        s.host.ok("M140 S60")
        bed = s.printer.rig.connection.heaters["bed"]
        s.host.send("G30 X110 Y110")
        assert s.until(lambda: bed.suspended, 60)
        s.printer.rig.connection.switch_heaters_off()
        assert s.until(lambda: not bed.suspended, 60)
        s.passes(5)
        assert (bed.target, bed.power) == (0.0, 0.0)


def test_stop_in_a_descent_lifts_the_nozzle_and_keeps_the_position():
    with homed() as s:
        s.host.send("G30 X110 Y110")
        assert s.until(lambda: s.positions()["x"] == 135 and s.positions()["z"] < 5, 30)
        s.host.send("M108")
        s.host.expect("^ok", 30)
        assert s.until(lambda: s.positions()["z"] == 10.0, 30)
        assert s.printer.rig.job.locked_axes == []
        assert probed(s, 110, 110) == pytest.approx(0.1249, abs=0.01)


def test_repeatability_is_that_of_the_bed():
    with homed() as s:
        s.board.spoil_probe(noise_mm=0.02)
        said = [x for x in s.host.ok("M48 P50 X110 Y110", 300) if "busy" not in x]
        assert said[:2] == ["M48 Z-Probe Repeatability Test", "Finished!"]
        mean, low, high, spread = (float(x) for x in re.findall(r"-?\d+\.\d+", said[2]))
        assert mean == pytest.approx(0.125, abs=0.01)
        assert spread == pytest.approx(high - low, abs=1.1e-3)
        # 50 samples: the standard deviation is known to a tenth of itself.
        assert float(said[3].removeprefix("Standard Deviation: ")) == pytest.approx(0.02, rel=0.35)
        s.host.ok("PROBE_ACCURACY SAMPLES=5", 60)
        assert s.host.heard[-2].startswith("// probe accuracy results: maximum 0.1")


def test_klippers_spellings_of_one_probe():
    with homed() as s:
        s.host.ok("G1 X135 Y105 F6000", 60)
        s.host.ok("PROBE", 60)
        assert re.fullmatch(
            r"// Result: at 110\.000,110\.000 estimate contact at z=0\.12\d+", s.host.heard[-2]
        )
        assert s.host.ok("QUERY_PROBE")[0] == "// probe: open"
        s.board.force_switch("probe", True)
        assert s.host.ok("QUERY_PROBE")[0] == "// probe: TRIGGERED"
        assert s.host.ok("M119")[-2] == "z_probe: TRIGGERED"


def test_probe_ends_straight_moves():
    with homed() as s:
        bed = simulated_bed(s.machine).shape
        s.host.ok("G1 X135 Y105 Z5 F6000", 60)
        (said,) = [x for x in s.host.ok("G38.2 Z0 F120", 60) if x.startswith("[PRB:")]
        x, y, z = (float(mm) for mm in said[5:].split(":")[0].split(","))
        assert (x, y, said[-3:]) == (135.0, 105.0, ":1]")
        assert z == pytest.approx(bed.height(110, 110) + 1.2, abs=STEP)
        assert s.positions()["z"] == pytest.approx(z, abs=STEP)
        assert "the probe is triggered already before the move" in refusal(s, "G38.2 Z0")
        # Away, until it opens, along all axes at once.
        (said,) = [x for x in s.host.ok("G38.4 X140 Z4 F120", 60) if x.startswith("[PRB:")]
        assert s.positions()["z"] == pytest.approx(z, abs=3 * STEP)
        assert s.positions()["x"] == pytest.approx(135, abs=0.05)
        s.host.ok("G91", 60)
        s.host.ok("G1 Z3 F600", 60)
        said = [x for x in s.host.ok("G38.3 Z-1", 60) if x.startswith("[PRB:")]
        assert said[0].endswith(":0]")
        (said, text) = [x for x in s.host.ok("G38.2 Z-0.5", 60) if "busy" not in x][:2]
        assert said.endswith(":0]")
        assert "the probe did not change" in text
        s.host.ok("G90", 60)
        assert "Z is 300: expected 0 to 250" in refusal(s, "G38.2 Z300")
        s.host.ok("G1 X50 Y50 Z5 F6000", 60)
        s.host.ok("M400", 60)
        assert s.positions() | {"e": 0} == {"x": 50.0, "y": 50.0, "z": 5.0, "e": 0}


def test_measuring_is_set_as_by_reprapfirmware():
    with homed() as s:
        s.host.ok("M558 F300:60 H8 A3 S0.02 R0.1 T3000")
        assert s.host.ok("M558")[0] == (
            "Z probe 0: type fixed, dive height 8.0mm, probe speed 300:60mm/min, travel speed"
            " 3000mm/min, max taps 3, tolerance 0.020mm, recovery time 0.10 sec"
        )
        assert probed(s, 110, 110) == pytest.approx(0.1249, abs=0.01)
        assert s.positions()["z"] == 8.0
        assert "samples is 99" in refusal(s, "M558 A99")
        assert "H is 2: expected more than 2.2" in refusal(s, "M558 H2")
