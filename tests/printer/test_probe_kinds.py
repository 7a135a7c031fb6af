"""Probes that are deployed and stowed: BLTouch, servo, dock, the nozzle itself; their faults."""

import re
from array import array

import pytest
from tests.support.edited_machine import STILL, answers, at_home, edited
from tests.support.scenario import Scenario

from passo.errors import ConfigError
from passo.printer.setup.simulated_world import simulated_bed

STEP = 1 / 400
FIXED = 'kind = "fixed"\npin = "^Z_MAX"\noffset_mm = [-25.0, 5.0]\ntrigger_height_mm = 1.2'
SENSED = 'pin = "^Z_MAX"\noffset_mm = [-25.0, 5.0]\ntrigger_height_mm = 1.2'
KINDS = {
    "bltouch": f'kind = "bltouch"\n{SENSED}\ncontrol_pin = "SERVO0"\noutput = "5v"',
    "touch mode": f'kind = "bltouch"\n{SENSED}\ncontrol_pin = "SERVO0"\ntouch_mode = true',
    "servo": f'kind = "servo"\n{SENSED}\ncontrol_pin = "SERVO0"\ntriggered_when_stowed = true',
    "dock": f'kind = "dock"\n{SENSED}\n'
    "approach_mm = [200, 180]\ndock_mm = [200, 215]\nleave_mm = [240, 215]",
    "nozzle": 'kind = "nozzle"\npin = "^Z_MAX"',
}


def machine(kind, *, passo=False, faults=""):
    jammed = "[heaters.hotend]", f"[simulated.probe]\n{faults}\n[heaters.hotend]"
    more = 'firmware = "passo"\n' if passo else ""
    return edited("i3-probe", STILL, (FIXED, KINDS.get(kind, kind)), jammed, more=more)


def homed(kind, **options):
    return at_home(machine(kind, **options))


def failed(s, line="G30 X110 Y110", **faults):
    """What a line answers with such faults, the lowest Z of the nozzle meanwhile, and the answer
    after the faults."""
    s.host.ok("M104 S210")
    s.board.spoil_probe(**faults)
    before = s.board.position("z")
    s.board.trace_steps("z", s.printer.rig.connection.now, 1 << 60)
    said = answers(s, line)
    at = low = round(before / STEP)
    for direction in array("b", s.board.take_steps("z", 0, 1 << 60)[1]):
        at += direction
        low = min(low, at)
    s.board.spoil_probe()
    assert s.printer.rig.job.locked_axes == []
    assert s.printer.rig.connection.heaters["hotend"].target == 210
    assert s.positions()["z"] >= 10.0
    return said[-1], low * STEP


@pytest.mark.parametrize("kind", KINDS)
def test_probe_is_deployed_and_measures_to_one_step(kind):
    with homed(kind) as s:
        bed = simulated_bed(s.machine).shape
        for x, y in [(30, 30), (110, 110)]:
            said = answers(s, f"G30 X{x} Y{y}")[-1]
            assert float(said.split()[-1]) == pytest.approx(bed.height(x, y), abs=STEP + 5e-4)
        # Stowed: a dock's or a servo's switch is triggered then.
        wanted = "TRIGGERED" if kind in ("servo", "dock") else "open"
        assert answers(s, "QUERY_PROBE") == [f"// probe: {wanted}"]


def test_bltouch_on_the_firmware_triggers_by_a_pulse_of_10_ms():
    with homed("bltouch", passo=True) as s:
        bed = simulated_bed(s.machine).shape
        said = answers(s, "G30 X110 Y110")[-1]
        assert float(said.split()[-1]) == pytest.approx(bed.height(110, 110), abs=STEP + 5e-4)


@pytest.mark.parametrize(
    ("kind", "says"),
    [
        ("bltouch", "it is triggered, and it should be open in touch mode with its pin down"),
        ("servo", "it is triggered, and it should be open with the servo at 70°"),
        ("dock", "it is triggered, and it should be open once the head has fetched the probe"),
    ],
)
def test_probe_that_does_not_deploy_never_descends(kind, says):
    with homed(kind) as s:
        said, low = failed(s, jammed=True)
        assert "the probe did not deploy" in said
        assert says in said
        assert low == 0.0  # of G28
        # Once it moves again, it measures.
        assert answers(s, "G30 X110 Y110")[-1].startswith("Bed X: 110.00")


def test_bltouch_without_verification_is_stopped_by_its_alarm():
    with homed(f"{KINDS['bltouch']}\nverify = false") as s:
        said, low = failed(s, jammed=True)
        assert "it should be open with its pin down; its lamp blinks in an alarm" in said
        assert low == 0.0


@pytest.mark.parametrize("kind", ["bltouch", "touch mode", "servo", "dock", "nozzle"])
def test_probe_that_does_not_trigger_stops_at_the_low_point(kind):
    with homed(kind) as s:
        x, y = (110, 110) if kind == "nozzle" else (135, 105)
        said, low = failed(s, dead_areas=[(x - 1, y - 1, x + 1, y + 1)])
        assert "the probe was not triggered at X110 Y110. The nozzle descended to" in said
        assert low == pytest.approx(-2, abs=STEP)


@pytest.mark.parametrize("kind", ["bltouch", "touch mode", "servo", "dock", "nozzle"])
def test_probe_that_triggers_early_is_refused(kind):
    with homed(kind) as s:
        x, y = (110, 110) if kind == "nozzle" else (135, 105)
        said, low = failed(s, touchy_areas=[(x - 1, y - 1, x + 1, y + 1)])
        assert re.search("triggered at X110 Y110|did not deploy: it is triggered", said)
        assert low == 0.0


@pytest.mark.parametrize("kind", ["bltouch", "touch mode", "servo", "dock", "nozzle"])
def test_probe_that_stays_triggered_never_descends(kind):
    with homed(kind) as s:
        s.board.force_switch("probe", True)
        said, low = failed(s)
        assert "is triggered" in said
        assert low == 0.0
        s.board.force_switch("probe", None)
        assert answers(s, "G30 X110 Y110")[-1].startswith("Bed X: 110.00")


def test_probe_that_falls_off_ends_the_run():
    with homed("dock") as s:
        s.host.ok("M401", 60)
        assert answers(s, "QUERY_PROBE") == ["// probe: open"]
        s.board.force_switch("probe", True)
        said, low = failed(s)
        assert "is triggered at X110 Y110" in said
        assert low == 10.0


def test_stop_in_a_descent_stows_the_probe():
    with homed("dock") as s:
        s.host.send("G30 X110 Y110")
        assert s.until(lambda: s.positions()["x"] == 135 and s.positions()["z"] < 5, 60)
        s.host.send("M108")
        s.host.expect("^ok", 60)
        assert s.positions() | {"e": 0} == {"x": 240.0, "y": 215.0, "z": 20.0, "e": 0}
        assert answers(s, "QUERY_PROBE") == ["// probe: TRIGGERED"]


@pytest.mark.parametrize("end", ["M524", "M410"])
def test_end_of_a_print_in_a_descent_stows_the_probe(tmp_path, end):
    (tmp_path / "a.gcode").write_text("G28\nG29\nG1 X10 F6000\n")
    with Scenario(machine("dock"), card=str(tmp_path)) as s:
        s.host.send("M23 a.gcode", "M24")
        assert s.until(lambda: s.positions()["x"] == 40 and s.positions()["z"] < 5, 120)
        s.host.send(end)
        assert s.until(lambda: s.positions()["x"] == 240.0, 30)
        assert answers(s, "QUERY_PROBE") == ["// probe: TRIGGERED"]
        assert s.positions()["z"] >= 10.0


def test_print_from_the_card_ends_where_the_probe_fails(tmp_path):
    (tmp_path / "a.gcode").write_text("M104 S60\nG28\nG29\nG1 X10 F6000\n")
    with Scenario(machine("bltouch"), card=str(tmp_path)) as s:
        s.board.force_switch("probe", False)
        s.host.send("M23 a.gcode", "M24")
        s.host.expect("a.gcode stopped: .*the probe", 120)
        assert s.positions()["z"] == 10.0
        assert s.positions()["x"] != 10.0
        assert s.printer.rig.job.locked_axes == []
        assert s.printer.motion.correction.correction is None


def test_deployed_probe_stays_between_runs_until_it_is_stowed():
    with homed("dock") as s:
        s.host.ok("M401", 60)
        s.host.ok("G30 X110 Y110", 60)
        assert s.positions()["x"] == 135.0
        assert answers(s, "QUERY_PROBE") == ["// probe: open"]
        s.host.ok("M402", 60)
        assert s.positions()["x"] == 240.0
        assert answers(s, "QUERY_PROBE") == ["// probe: TRIGGERED"]


def test_commands_of_a_bltouch():
    with homed("bltouch") as s:
        s.board.trace_output("probe-servo")
        for line, width_us in [("M280 P0 S160", 2193.8), ("BLTOUCH_DEBUG COMMAND=self_test", 1780)]:
            s.board.take_changes("probe-servo")
            s.host.ok(line, 60)
            (_, on), (_, off) = s.board.take_changes("probe-servo")
            assert on / 16 == pytest.approx(width_us, abs=0.1)
            assert off == 0
        assert "S is 300: expected 0 to 180° or 544 to 2500 us" in answers(s, "M280 P0 S300")[0]
        assert "COMMAND is up: expected pin_down" in answers(s, "BLTOUCH_DEBUG COMMAND=up")[0]
    with homed("nozzle") as s:
        assert (
            "neither a servo with a number nor a probe with a servo" in answers(s, "M280 P0 S10")[0]
        )


def test_probe_is_stowed_when_the_boards_start():
    with homed("servo") as s:
        s.host.ok("M401", 60)
        assert answers(s, "QUERY_PROBE") == ["// probe: open"]
        s.host.send("M112")
        s.passes(1)
        s.host.ok("M999", 60)
        s.passes(1)
        assert answers(s, "QUERY_PROBE") == ["// probe: TRIGGERED"]


@pytest.mark.parametrize(
    ("kind", "old", "new", "says"),
    [
        ("dock", "[200, 215]", "[200, 230]", r"dock_mm is .*Y0 to Y220, which the nozzle reaches"),
        ("dock", "leave_mm", "dock_height_mm = 8\nleave_mm", "at least start_mm, which is 10"),
        ("servo", '"SERVO0"', '"^Z_MIN"', "homing.z.pin"),
        ("nozzle", '"nozzle"', '"finger"', "kind"),
    ],
)
def test_kind_that_cannot_work_is_refused(kind, old, new, says):
    assert old in KINDS[kind]
    with pytest.raises(ConfigError, match=says):
        machine(KINDS[kind].replace(old, new))
