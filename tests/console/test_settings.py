"""Settings on consoles: reported so that they can be sent back, stored whole or refused."""

import errno
import json
import os
import re
import zlib
from pathlib import Path

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text

CHANGES = (
    "M92 X100 E120.5",
    "M203 X120 Z6",
    "M201 Y900",
    "M204 P800 R1200 T1500",
    "M205 J0.05",
    "SET_VELOCITY_LIMIT VELOCITY=70 MINIMUM_CRUISE_RATIO=0.25",
    "M206 Z-0.3",
    "M207 S2 F1800 Z0.5",
    "M145 S0 H201 B61 F200",
    "M302 S150",
    "M84 S90",
    "M85 S7200.5",
    "M540 S1",
)


def report(s):
    return [line for line in s.host.ok("M503 S0") if line != "ok"]


@pytest.fixture
def s(tmp_path):
    with Scenario("i3", state=str(tmp_path)) as scenario:
        yield scenario


def test_m503_reports_values_in_force(s):
    lines = s.host.ok("M503")
    assert "; Steps per unit" in lines
    assert "M92 X80 Y80 Z400 E95.5" in lines
    assert "M203 X300 Y300 Z12 E100" in lines
    assert "M204 P3000 R5000 T3000" in lines


def test_the_report_sent_back_gives_the_same_state(s):
    for line in CHANGES:
        assert s.host.ok(line) == ["ok"], line
    changed = report(s)
    assert "M92 X100 Y80 Z400 E120.5" in changed
    s.host.ok("M502")
    assert report(s) != changed
    for line in changed:
        assert s.host.ok(line) == ["ok"], line
    assert report(s) == changed
    assert (s.printer.outputs.motors.idle_s, s.printer.prompts.kill_s) == (90, 7200.5)
    assert s.printer.endstops.stops


def test_idle_times_and_the_stop_at_endstops_are_settings(tmp_path):
    """They are stored, come back at the next start and go with M502."""
    with Scenario("i3", state=str(tmp_path)) as s:
        assert [x for x in report(s) if x.startswith(("M84 ", "M85 ", "M540 "))] == [
            "M84 S600",
            "M85 S0",
            "M540 S0",
        ]
        for line in ("M84 S90", "M85 S60", "M540 S1", "M500"):
            s.host.ok(line)
    with Scenario("i3", state=str(tmp_path)) as s:
        assert (s.printer.outputs.motors.idle_s, s.printer.prompts.kill_s) == (90, 60)
        assert s.printer.endstops.stops
        s.passes(61)
        assert s.printer.state.halted == "idle for 60 s (M85)"
        s.host.send("M999")
        s.host.expect("ready again", 3)
        s.host.ok("M502")
        assert s.host.ok("M85")[0] == "M85 S0"
        assert s.host.ok("M540")[0] == "M540 S0"


def test_speed_and_flow_factors_are_not_settings(tmp_path):
    """M220 and M221 belong to one print: they are neither reported nor stored."""
    with Scenario("i3", state=str(tmp_path)) as s:
        before = report(s)
        for line in ("M220 S50", "M221 S80", "M500"):
            s.host.ok(line)
        assert report(s) == before
    with Scenario("i3", state=str(tmp_path)) as s:
        assert "50%" not in " ".join(s.host.ok("M220"))
        assert "80%" not in " ".join(s.host.ok("M221"))


def test_the_machine_files_retraction_comes_back_whole(s):
    before = report(s)
    s.host.ok("M208 S0.2 F1200 W0.3")
    s.host.ok("M502")
    assert report(s) == before


def test_report_omits_settings_that_follow_from_others(s):
    """If the report is sent back, the speed of G11 still follows M207."""
    for line in report(s):
        s.host.ok(line.removeprefix("echo:"))
    s.host.ok("M207 F1200")
    assert s.printer.rig.job.modes.retraction[1:5:3] == (20.0, 0.0)
    for line in ("M208 F600", "M208 F0"):
        assert s.host.ok(line) == ["ok"]
    assert s.printer.rig.job.modes.retraction[4] == 0.0


def test_stored_settings_come_back_at_the_next_start(tmp_path):
    with Scenario("i3", state=str(tmp_path)) as s:
        for line in CHANGES:
            s.host.ok(line)
        stored = report(s)
        assert re.match(r"echo:Settings Stored \(\d+ bytes; crc \d+\)", s.host.ok("M500")[0])
        s.host.ok("M203 X50")
        s.host.ok("M501")
        assert report(s) == stored
        assert "sound" in s.host.ok("M504")[0]
    with Scenario("i3", state=str(tmp_path)) as s:
        assert report(s) == stored
    with Scenario("corexy", state=str(tmp_path)) as s:
        assert "belongs to another machine" in s.host.ok("M504")[0]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("M206 Z0.00005", "M206 X0 Y0 Z0.00005"),
        ("M218 T0 X-0.00002", "M218 T0 X-0.00002 Y0 Z0"),
        ("M301 H0 P1 I0.00001 D2", "M301 H0 P1 I0.00001 D2"),
        ("M305 H0 C0.0000000123456", "M305 H0 A100000 B3950 C0.0000000123456 R4700 L0 O0"),
        ("M145 S0 H0.00001", None),
        ("M207 S0.00001", None),
        ("M85 S0.00001", "M85 S0.00001"),
        ("M302 S0.00001", "M302 S0.00001 P0"),
        ("SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY=0.3", None),
        ("SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY=90", "M205 J0.3"),
    ],
)
def test_tiny_numbers_have_no_exponent_whose_e_would_be_a_word(tmp_path, line, told):
    with Scenario("i3", state=str(tmp_path)) as s:
        s.host.ok(line)
        before = report(s)
        assert told is None or told in before
        s.host.ok("M500")
    with Scenario("i3", state=str(tmp_path)) as s:
        assert report(s) == before


def test_the_speed_of_square_corners_is_stored(tmp_path):
    words = {"VELOCITY": "150", "SQUARE_CORNER_VELOCITY": "8"}
    with Scenario("voron-0", state=str(tmp_path)) as s:
        s.host.ok("SET_VELOCITY_LIMIT " + " ".join(f"{k}={v}" for k, v in words.items()))
        s.host.ok("M500")
    with Scenario("voron-0", state=str(tmp_path)) as s:
        line = "SET_VELOCITY_LIMIT VELOCITY=150 MINIMUM_CRUISE_RATIO=0 SQUARE_CORNER_VELOCITY=8"
        assert line in report(s)
        assert s.host.ok("M205") == [line, "ok"]
        note, _ = s.host.ok("M205 J0.05")
        assert "use the speed at right angles" in note


def edited(**values):
    """The i3 with other values in its file."""
    text = shipped_text("i3")
    for old, new in values.values():
        assert old in text
        text = text.replace(old, new)
    return config.load_text(text)


SCALE = ("steps_per_mm = 80.0", "steps_per_mm = 90.0")
TO_FILE = "echo:To go back to the machine file's values: M502, then M500"


def rows_of(tmp_path):
    content = json.loads((tmp_path / "settings.json").read_text())
    return {row["set"]: row["file"] for row in content["settings"]}


def heard_at_start(s):
    unreported, s.printer.state.unreported = s.printer.state.unreported, []
    return unreported


def test_only_changed_values_are_stored(tmp_path):
    with Scenario("i3", state=str(tmp_path)) as s:
        s.host.ok("M500")
        assert rows_of(tmp_path) == {}
        for line in ("M92 X100", "M203 Y300", "M301 H0 I1.5"):
            s.host.ok(line)
        told = s.host.ok("M500")
        assert told[1] == "echo:Stored, as changed from the machine file: M92 X100, M301 H0 I1.5"
        assert rows_of(tmp_path) == {"M92 X100": "80", "M301 H0 I1.5": "1.258223684"}
        assert heard_at_start(s) == []


def test_edits_of_the_file_count_after_m500(tmp_path):
    with Scenario("i3", state=str(tmp_path)) as s:
        s.host.ok("M92 X100")
        s.host.ok("M500")
    with Scenario(edited(scale=SCALE), state=str(tmp_path)) as s:
        assert s.host.ok("M92")[0] == "M92 X100 Y90 Z400 E95.5"
        assert heard_at_start(s) == [
            "echo:Stored M92 X100 overrides X90 of the machine file. The file was edited after"
            " M500: it had X80",
            TO_FILE,
        ]
        s.host.ok("M500")  # the file's value of now
        assert rows_of(tmp_path) == {"M92 X100": "90"}
    with Scenario(edited(scale=SCALE), state=str(tmp_path)) as s:
        assert heard_at_start(s) == [
            "echo:Stored M92 X100 overrides X90 of the machine file",
            TO_FILE,
        ]
        for line in ("M502", "M500"):
            s.host.ok(line)
        assert rows_of(tmp_path) == {}
    with Scenario("i3", state=str(tmp_path)) as s:
        assert s.host.ok("M92")[0] == "M92 X80 Y80 Z400 E95.5"


def test_a_stored_value_that_the_file_has_leaves_the_store(tmp_path):
    with Scenario("i3", state=str(tmp_path)) as s:
        for line in ("M92 X90 Y90", "M84 S90", "M500"):
            s.host.ok(line)
    with Scenario(edited(scale=SCALE), state=str(tmp_path)) as s:
        assert heard_at_start(s) == [
            "echo:Stored M84 S90 overrides S600 of the machine file",
            TO_FILE,
        ]
        assert rows_of(tmp_path) == {"M84 S90": "600"}
    with Scenario("i3", state=str(tmp_path)) as s:
        assert s.host.ok("M92")[0] == "M92 X80 Y80 Z400 E95.5"


def test_a_store_of_all_values_is_reduced_to_those_that_differ(tmp_path):
    with Scenario("i3") as s:
        lines = report(s)
    lines[lines.index("M92 X80 Y80 Z400 E95.5")] = "M92 X123 Y80 Z400 E95.5"
    crc = zlib.crc32("\n".join(lines).encode())
    uuid = config.load("i3").uuid
    old = {"version": 1, "machine": uuid, "crc": crc, "settings": lines}
    (tmp_path / "settings.json").write_text(json.dumps(old))
    with Scenario(edited(scale=SCALE), state=str(tmp_path)) as s:
        assert s.host.ok("M92")[0] == "M92 X123 Y80 Z400 E95.5"
        assert heard_at_start(s) == [
            "echo:Stored M92 X123 overrides X90 of the machine file",
            "echo:Stored M92 Y80 overrides Y90 of the machine file",
            TO_FILE,
        ]
        assert rows_of(tmp_path) == {"M92 X123": None, "M92 Y80": None}


def test_a_stored_value_beyond_the_files_limits_is_named(tmp_path):
    with Scenario("i3", state=str(tmp_path)) as s:
        for line in ("M306 H0 A100", "M500"):
            s.host.ok(line)
    head = "[heaters.hotend]\n"
    less = edited(pid=(head, head + 'control = { kind = "pid", drive_max = 0.2 }\n'))
    with Scenario(less, state=str(tmp_path)) as s:
        refused, named, _ = heard_at_start(s)
        assert refused.startswith(
            "echo:A stored setting was refused: B is 51: expected more than A"
        )
        assert named == "echo:Stored M306 H0 A100 could not be taken as it is: A0 is in force"


@pytest.mark.parametrize("code", ["M501", "M502"])
def test_settings_come_back_when_the_machine_is_idle(tmp_path, code):
    """Its moves were planned in the scales of before."""
    with Scenario("i3", state=str(tmp_path)) as s:
        s.host.ok("M500")
        s.host.ok("M92 X80.5")
        s.host.ok("G28", 100)
        s.host.send("G1 X100 F3000", code, "M105", "M92")
        s.passes(1)
        s.host.ok("M220 S50")
        s.host.expect("M92 X80 ", 30)
        assert s.positions()["x"] == pytest.approx(100 * 80.5 / 80)
        s.host.ok("G1 X0")
        s.host.ok("M400", 30)
        assert s.positions()["x"] == pytest.approx(100 * 0.5 / 80)
        assert not s.printer.state.halted


def with_rows(text, rows):
    return json.dumps(json.loads(text) | {"settings": rows})


@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (lambda text: text[: len(text) // 2], "torn"),
        (lambda text: "", "torn"),
        (lambda text: "[]", "torn"),
        (lambda text: text.replace("M203 X120", "M203 X121"), "checksum"),
        (lambda text: text.replace('"file": "300"', '"file": "301"'), "checksum"),
        (lambda text: text.replace('"version": 2', '"version": 9'), "version 9"),
        (lambda text: with_rows(text, [1]), "no commands"),
        (lambda text: with_rows(text, [{"set": "M203", "file": None}]), "no commands"),
        (lambda text: with_rows(text, [{"set": "M203 X1 Y2", "file": None}]), "no commands"),
        (lambda text: with_rows(text, [{"set": "M203 X\ud800", "file": None}]), "checksum"),
        (lambda text: "[" * 100_000, "torn"),
    ],
)
def test_damaged_settings_file_is_refused_with_reason(tmp_path, damage, reason):
    with Scenario("i3", state=str(tmp_path)) as s:
        defaults = report(s)
        s.host.ok("M203 X120")
        s.host.ok("M500")
        file = tmp_path / "settings.json"
        file.write_text(damage(file.read_text()))
        assert reason in s.host.ok("M501")[0]
    with Scenario("i3", state=str(tmp_path)) as s:
        assert report(s) == defaults


def test_m500_without_state_folder_fails(tmp_path):
    with Scenario("i3") as s:
        assert "there is no place to store settings" in s.host.ok("M500")[0]
    (tmp_path / "file").write_text("")
    with Scenario("i3", state=str(tmp_path / "file")) as s:
        assert "the settings were not stored" in s.host.ok("M500")[0]


@pytest.mark.parametrize("failing", ["fsync", "replace"])
def test_failed_store_keeps_old_settings(s, tmp_path, monkeypatch, failing):
    s.host.ok("M500")
    old = (tmp_path / "settings.json").read_bytes()
    before = sorted(path.name for path in tmp_path.iterdir())
    s.host.ok("M203 X50")

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os if failing == "fsync" else Path, failing, full)
        assert "the settings were not stored: No space left" in s.host.ok("M500")[0]
    assert (tmp_path / "settings.json").read_bytes() == old
    assert sorted(path.name for path in tmp_path.iterdir()) == before
    assert "Settings Stored" in s.host.ok("M500")[0]


def test_a_halt_keeps_the_settings(s):
    s.host.ok("M203 X77")
    s.host.send("M112")
    s.host.expect("halted", 5)
    s.host.send("M999")
    s.host.expect("ready again", 5)
    assert any(line.startswith("M203 X77 ") for line in report(s))


def test_a_new_scale_counts_from_the_next_move(s):
    s.host.ok("G28", 60)
    s.host.ok("G1 X10 F3000")
    s.host.ok("M92 X40")
    s.host.ok("G1 X20")
    s.host.ok("M400")
    assert s.positions()["x"] == 15.0  # the mechanics still take 80 steps for a mm
    assert "X:20.000" in s.host.ok("M114")[0]
    assert "X is -3" in s.host.ok("M92 X-3")[0]


def test_a_new_feed_factor_acts_on_moves_that_are_planned(s):
    s.host.ok("G92 X0 Y0 Z0")
    s.host.ok("G1 X100 F600")
    s.passes(1)
    s.host.ok("M220 S400")
    assert s.host.ok("M220")[0] == "Speed factor override: 400"
    s.passes(3)
    assert s.positions()["x"] == pytest.approx(120, abs=0.1)
    assert "S is -5" in s.host.ok("M220 S-5")[0]
    assert s.printer.rig.job.limits.speed_factor == 4


def test_the_flow_is_reported(s):
    assert s.host.ok("M221")[0] == "echo:E0 Flow: 100%"
    s.host.ok("M221 S95")
    assert s.host.ok("M221")[0] == "echo:E0 Flow: 95%"


def test_motors_switched_off_are_not_homed(s):
    s.host.ok("G28", 60)
    on = {x: s.board.output_value(f"{x}-enable") for x in "xyze"}
    assert on == {"x": 0, "y": 0, "z": 0, "e": 0}  # low switches an A4988 on
    s.host.ok("M84 X")
    s.passes(0.1)
    assert s.board.output_value("x-enable") == 1
    assert s.board.output_value("y-enable") == 0
    assert "axis X is not homed" in s.host.ok("G1 X5")[0]
    assert s.host.ok("G1 Y5 F3000") == ["ok"]
    s.host.ok("M18")
    s.passes(0.1)
    assert s.board.output_value("z-enable") == 1
    s.host.ok("G28", 60)
    s.host.ok("M84 S5")
    s.passes(4)
    assert s.board.output_value("x-enable") == 0
    s.host.expect("Motors off after an idle time", 3)
    s.passes(0.1)
    assert s.board.output_value("x-enable") == 1


def test_heaters_go_off_after_half_an_hour(s):
    s.host.ok("M140 S40")
    s.passes(1790)
    assert s.printer.rig.connection.heaters["bed"].target == 40
    s.host.expect("Heater bed off after an idle time", 30)


def test_filament_changes_wait_for_the_user(s):
    s.host.send("M600")
    s.host.expect("^// action:pause", 1)
    s.host.silent(20, "^ok")
    s.host.send("M108")
    s.host.expect("^ok", 1)


def test_m0_waits_for_the_user_or_a_time(s):
    s.host.send("M0 S5 Look here")
    s.host.expect("prompt_begin Look here", 1)
    start = s.loop.time()
    s.host.expect("^ok", 10)
    assert s.loop.time() - start == pytest.approx(5, abs=0.3)
    s.host.send("M0 Look")
    s.host.silent(10, "^ok")
    s.host.send("M876 P1")
    s.host.silent(1, "^ok")
    s.host.send("M876 S0")
    s.host.expect("prompt_end", 1)
    s.host.expect("^ok", 1)


def test_second_nozzle_is_offset_from_first(tmp_path):
    """Both nozzles print in the same place: one that is 10 mm to the right of the first gets there
    10 mm further to the left."""
    with Scenario("dual-extruder") as s:
        s.host.ok("M302 S0")
        s.host.ok("G28", 60)
        s.host.ok("M218 T1 X10 Y0 Z0")
        s.host.ok("T1")
        s.host.ok("G1 X50 F6000")
        s.host.ok("M400")
        assert s.positions()["x"] == pytest.approx(50 - 10, abs=0.01)
        s.host.ok("M218 T1 X12 Y0 Z0")
        s.host.ok("G1 X50")
        s.host.ok("M400")
        assert s.positions()["x"] == pytest.approx(50 - 12, abs=0.01)
        assert "M218 T1 X12 Y0 Z0" in s.host.ok("M218")


@pytest.mark.parametrize(("machine", "word"), [("dual-extruder", "T0 "), ("i3", "")])
def test_an_offset_of_the_first_tool_is_reported_kept_and_undone(machine, word, tmp_path):
    with Scenario(machine, state=str(tmp_path)) as s:
        s.host.ok(f"M218 {word}X5")
        assert s.host.ok("M218")[0] == "M218 T0 X5 Y0 Z0"
        assert "M218 T0 X5 Y0 Z0" in s.host.ok("M503 S0")
        s.host.ok("M500")
    with Scenario(machine, state=str(tmp_path)) as s:
        assert s.host.ok("M218")[0] == "M218 T0 X5 Y0 Z0"
        s.host.ok("G28", 60)
        s.host.ok("G1 X10 F6000")
        s.host.ok("M400")
        assert s.positions()["x"] == pytest.approx(5, abs=0.01)
        s.host.ok("M502")
        assert s.host.ok("M218")[0] == "M218 T0 X0 Y0 Z0"
        s.host.ok("G1 X20")
        s.host.ok("M400")
        assert s.positions()["x"] == pytest.approx(20, abs=0.01)


def test_babysteps_shift_the_moves_that_follow(s):
    s.host.ok("G28", 60)
    s.host.ok("G1 Z5 F600")
    s.host.ok("M290 Z0.2")
    s.host.ok("G1 Z6")
    s.host.ok("M400")
    assert s.positions()["z"] == 6.2
    assert "-2 to 2 mm" in s.host.ok("M290 Z3")[0]


def of_both_extruders(s):
    job = s.printer.rig.job
    scales = {row["name"]: row["steps_per_unit"] for row in job.motors.statistics()}
    return [
        (scales[e], job.limits.of_axis(e, "speed"), job.limits.of_axis(e, "accel"))
        for e in ("e", "e1")
    ]


def test_each_extruder_keeps_its_settings(tmp_path):
    with Scenario("dual-extruder", state=str(tmp_path)) as s:
        for line in ("T1", "M92 E200", "M203 E11", "M201 E700"):
            assert s.host.ok(line) == ["ok"], line
        changed = [(95.5, 100, 5000), (200, 11, 700)]
        assert of_both_extruders(s) == changed
        lines = report(s)
        assert "M92 X80 Y80 Z400" in lines
        assert {"M92 T0 E95.5", "M92 T1 E200", "M203 T1 E11", "M201 T1 E700"} <= set(lines)
        assert s.host.ok("M92")[:-1] == [line for line in lines if line.startswith("M92")]
        s.host.ok("M500")
        s.host.ok("M502")
        assert of_both_extruders(s) == [(95.5, 100, 5000)] * 2
        for line in lines:  # whichever tool is active
            assert s.host.ok(line) == ["ok"], line
        assert report(s) == lines
        s.host.send("M112")
        s.host.expect("halted", 5)
        s.host.send("M999")
        s.host.expect("ready again", 5)
        assert of_both_extruders(s) == changed
        assert "T is 7" in s.host.ok("M92 T7 E100")[0]
        assert "T is 0.5" in s.host.ok("M203 T0.5 E50")[0]
        s.host.ok("M203 T0 E50")
        assert of_both_extruders(s) == [(95.5, 50, 5000), (200, 11, 700)]
    with Scenario("dual-extruder", state=str(tmp_path)) as s:
        assert of_both_extruders(s) == changed
