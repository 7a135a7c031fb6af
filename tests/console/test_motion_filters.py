"""M593, M900, M572 and Klipper's names for them, from the console and from files to the steps."""

from __future__ import annotations

import json

import pytest
from tests.support.disturbed_prints import steps
from tests.support.scenario import Scenario

from passo import config
from passo._core import Job, JobStatus
from passo.cli.main import main
from passo.config.load import shipped_text

SHAPED = """
[shaping.x]
type = "zvd"
frequency_hz = 47.0
damping = 0.08
[shaping.y]
frequency_hz = 35.5
"""
OFF = "SET_INPUT_SHAPER SHAPER_FREQ_{0}=0 SHAPER_TYPE_{0}=mzv DAMPING_RATIO_{0}=0.1"


@pytest.fixture
def machine(tmp_path):
    """The file of an i3 with shapers and advance."""
    text = shipped_text("i3").replace("[extruders.e]", "[extruders.e]\nadvance_s = 0.05")
    path = tmp_path / "shaped.toml"
    path.write_text(text + SHAPED)
    return str(path)


def settings(s):
    words = "INPUT_SHAPER", "JERK_LIMIT", "PRESSURE"
    return [line for line in s.host.ok("M503") if any(word in line for word in words)]


def test_machine_file_sets_shapers_and_advance(machine):
    with Scenario(machine) as s:
        assert settings(s) == [
            "SET_INPUT_SHAPER SHAPER_FREQ_X=47 SHAPER_TYPE_X=zvd DAMPING_RATIO_X=0.08",
            "SET_INPUT_SHAPER SHAPER_FREQ_Y=35.5 SHAPER_TYPE_Y=mzv DAMPING_RATIO_Y=0.1",
            OFF.format("Z"),
            "SET_JERK_LIMIT JERK=0",
            "SET_PRESSURE_ADVANCE ADVANCE=0.05 SMOOTH_TIME=0.02",
        ]


def test_commands_set_shapers_of_axes():
    with Scenario("i3") as s:
        assert s.host.ok('M593 Y F40 D0.2 P"ei"') == ["ok"]
        assert s.host.ok("SET_INPUT_SHAPER SHAPER_FREQ_X=55 SHAPER_TYPE_X=2hump_ei") == ["ok"]
        assert s.host.ok("M593")[:3] == [
            "SET_INPUT_SHAPER SHAPER_FREQ_X=55 SHAPER_TYPE_X=2hump_ei DAMPING_RATIO_X=0.1",
            "SET_INPUT_SHAPER SHAPER_FREQ_Y=40 SHAPER_TYPE_Y=ei DAMPING_RATIO_Y=0.2",
            OFF.format("Z"),
        ]
        assert s.host.ok("SET_INPUT_SHAPER SHAPER_TYPE_X=EI(v_tol=.02) ; a comment") == ["ok"]
        assert s.host.ok('M593 Y P"ei(v_tol=0.1)" (a comment)') == ["ok"]
        assert s.host.ok("M593")[:2] == [
            "SET_INPUT_SHAPER SHAPER_FREQ_X=55 SHAPER_TYPE_X=ei(v_tol=0.02) DAMPING_RATIO_X=0.1",
            "SET_INPUT_SHAPER SHAPER_FREQ_Y=40 SHAPER_TYPE_Y=ei(v_tol=0.1) DAMPING_RATIO_Y=0.2",
        ]
        s.host.ok("M593 F0")
        assert all("_X=0 " in line or "_Y=0 " in line for line in s.host.ok("M593")[:2])


def test_commands_set_the_advance():
    with Scenario("i3") as s:
        assert s.host.ok("M900 K0.05") == ["ok"]
        assert s.host.ok("M900") == ["Advance K=0.05", "ok"]
        s.host.ok("M572 D0 S0.06")
        assert s.host.ok("M572 D0") == ["Extruder 0 pressure advance: 0.06 s", "ok"]
        s.host.ok("SET_PRESSURE_ADVANCE ADVANCE=0.07 SMOOTH_TIME=0.03")
        assert s.host.ok("SET_PRESSURE_ADVANCE EXTRUDER=extruder") == [
            "pressure_advance: 0.070000",
            "pressure_advance_smooth_time: 0.030000",
            "ok",
        ]


def test_command_limits_jerk():
    with Scenario("i3") as s:
        assert s.host.ok("SET_JERK_LIMIT JERK=200000") == ["ok"]
        assert s.host.ok("SET_JERK_LIMIT") == ["SET_JERK_LIMIT JERK=200000", "ok"]
        assert (
            s.printer.rig.commands.filters.delay_s == s.printer.rig.commands.filters.box_s / 2 > 0
        )
        s.host.ok("SET_JERK_LIMIT JERK=0")
        assert s.printer.rig.commands.filters.delay_s == 0


def test_commands_report_the_knees_of_the_advance():
    """M900 scales them."""
    knees = "advance_s = 0.1\nadvance_knees = [[2.0, 0.05]]\n"
    text = shipped_text("i3").replace("[extruders.e]\n", "[extruders.e]\n" + knees)
    with Scenario(config.load_text(text)) as s:
        s.host.ok("M900 K0.08")
        above = "above 2 mm/s of filament: 0.04 s"
        assert s.host.ok("M900") == ["Advance K=0.08", above, "ok"]
        assert s.host.ok("M572 D0")[1:] == [above, "ok"]
        assert s.host.ok("SET_PRESSURE_ADVANCE")[2:] == [above, "ok"]


REFUSED = {
    "SET_JERK_LIMIT JERK=100": "JERK is 100: expected 0 (no limit), or 40000 to 1e+09 mm/s³",
    "SET_JERK_LIMIT JERK=nan": "the word 'JERK=nan' has no valid number",
    "M593 F10": "F is 10: expected 0 (off), or 15 to 500 Hz",
    'M593 X F40 P"nope"': "type is nope: expected zv, mzv, zvd, ei, 2hump_ei, 3hump_ei, or ei(v",
    'M593 X F40 D0.35 P"3hump_ei"': "damping ratio is 0.35: expected 0 to 0.2 for the type 3hump",
    "M900 K-1": "K is -1: expected at least 0 s",
    "M900 K30": "M900: K30 is of Linear Advance 1.0 and has no effect",
    "M572 D3 S0.1": "D is 3: expected an extruder below 1",
    "SET_PRESSURE_ADVANCE SMOOTH_TIME=0.5": "SMOOTH_TIME is 0.5: expected 0 to 0.2 s",
    "SET_PRESSURE_ADVANCE ADVANCE=much": "the word 'ADVANCE=much' has no valid number",
    "SET_PRESSURE_ADVANCE EXTRUDER=e7 ADVANCE=0": "EXTRUDER is e7: expected extruder",
}


@pytest.mark.parametrize("line", REFUSED)
def test_filter_beyond_its_range_is_refused(line):
    with Scenario("i3") as s:
        before = settings(s)
        assert REFUSED[line] in s.host.ok(line)[0]
        assert settings(s) == before


def test_m500_keeps_filters_that_differ_from_the_file(machine, tmp_path):
    state = str(tmp_path / "state")
    with Scenario(machine, state=state) as s:
        s.host.ok("M593 X F52")
        s.host.ok("M900 K0.08")
        s.host.ok("SET_JERK_LIMIT JERK=150000")
        assert "SHAPER_FREQ_X=52, " in " ".join(s.host.ok("M500"))
    with Scenario(machine, state=state) as s:
        kept = settings(s)
        assert "SHAPER_FREQ_X=52 SHAPER_TYPE_X=zvd" in kept[0]
        assert kept[3:] == [
            "SET_JERK_LIMIT JERK=150000",
            "SET_PRESSURE_ADVANCE ADVANCE=0.08 SMOOTH_TIME=0.02",
        ]
        s.host.ok("M502")
        assert "SHAPER_FREQ_X=47" in settings(s)[0]
        assert "JERK=0" in settings(s)[3]
        assert "ADVANCE=0.05" in settings(s)[4]


PART = "".join(
    f"M900 K{0.02 + i % 5 * 0.01:g}\nG1 X{60 + i * 7 % 40} Y{60 + i * 11 % 30} E{i * 0.4:g} F4800\n"
    for i in range(1, 60)
)


def steps_of(capsys, path, machine):
    assert main(["print", path, "--machine", machine, "--assume-ready", "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_offline_print_is_filtered_with_the_counts_of_the_plan(capsys, tmp_path, machine):
    path = tmp_path / "part.gcode"
    path.write_text("G28\nG92 E0\nG1 X50 Y50 F6000\n" + PART)
    shaped = steps_of(capsys, str(path), machine)
    plain = steps_of(capsys, str(path), "i3")
    assert shaped["final_position_mm"] == plain["final_position_mm"]
    assert shaped["stream_hash"] != plain["stream_hash"]


def test_m900_in_mid_print_stops_nothing(machine):
    """Whatever the commands between them say, the moves join at the speed of their corner."""

    def moves(text):
        job = Job(config.load(machine).core_spec())
        job.results.keep_moves(True)
        job.feed(text.encode())
        while job.advance() == JobStatus.EVENT:
            code, value = job.event[1:3], job.event[5]
            assert code == ("M", 900)
            job.filters.set_advance(0, float(value.strip().removeprefix("K")))
        job.flush()
        return [m.end_speed for m in job.results.take_moves()]

    with_advances = moves("G1 X50 Y50 F6000\n" + PART)
    without = "\n".join(line for line in PART.splitlines() if not line.startswith("M900"))
    plain = moves("G1 X50 Y50 F6000\n" + without + "\n")
    assert [speed > 0 for speed in with_advances] == [speed > 0 for speed in plain]


def test_shapers_changed_in_mid_print_shift_nothing():
    def ends(*changes):
        with Scenario("i3") as s:
            s.host.ok("G28", 60)
            for i, change in enumerate(changes):
                s.host.ok(f"G1 X{20 + i % 2 * 60} Y{30 + i * 7} F9000")
                s.host.ok(f"G1 X{30 + i % 2 * 60}")
                s.host.ok(change)
                s.host.ok(f"G1 X{40 + i % 2 * 20} Y{20 + i * 7}")
            s.host.ok("M400", 60)
            return steps(s), s.host.ok("M114")

    changes = ("M593 F45", "M593 X F30", 'M593 Y P"ei"', "M900 K0.1", "M593 F0", "M593 Z F60")
    assert ends(*changes) == ends(*["M400"] * len(changes))


def test_a_short_smoothing_time_is_taken_with_its_cost():
    """5000 mm/s² of filament, divided by 0.06 mm a mm and 1 + 2 * 0.05 / 0.001."""
    with Scenario("i3") as s:
        assert s.host.ok("SET_PRESSURE_ADVANCE ADVANCE=0.05 SMOOTH_TIME=0.02") == ["ok"]
        (said, _) = s.host.ok("SET_PRESSURE_ADVANCE SMOOTH_TIME=0")
        assert said.startswith("echo:SMOOTH_TIME 0: it counts as 0.001 s; the extruder's accel")
        assert f"a line of 0.5 x 0.3 mm {5000 / 0.06 / 101:.0f} mm/s2 of the 3000" in said
        assert s.host.ok("SET_PRESSURE_ADVANCE")[1] == "pressure_advance_smooth_time: 0.001000"
        (said, _) = s.host.ok("SET_PRESSURE_ADVANCE SMOOTH_TIME=0.002")
        assert "SMOOTH_TIME 0.002: the extruder's accel_mm_s2 of 5000 then allows" in said
        assert s.host.ok("SET_PRESSURE_ADVANCE ADVANCE=0 SMOOTH_TIME=0.001") == ["ok"]
