"""Commands and words that do nothing here say so, once a console; settings are not taken for speeds
or for something else."""

import re

import pytest
from tests.support.scenario import Host, Scenario

from passo import config
from passo.cli.main import main
from passo.config.load import shipped_text


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        yield scenario


NOTES = {
    "M300 S440 P200": "M300 does nothing here. The machine file has no [beeper].",
    "M413 S0": "M413 does nothing here. A print can always be resumed",
    "M202 X1000": "M202 does nothing here. M201 limits the axes in every move, M204 T all travel.",
    "M907 X500": "M907 does nothing here. M906 and the machine file set motor currents.",
    "M862.3 P MK3S": "M862.3 does nothing here. The command checks that the printer is a Prusa.",
    "G27": "G27 does nothing here. M25 and M601 park the head.",
    "M420 S1": "M420 does nothing here. This machine has no probe.",
    "M800": "M800 does nothing here. M1000 resumes a print",
    "EXCLUDE_OBJECT_START NAME=a": "EXCLUDE_OBJECT_START labels objects of a file on the card",
    "M205 X8 Y8 S0": "M205: X Y have no effect, because the machine's corners use the junction",
    "SET_VELOCITY_LIMIT ACCEL_TO_DECEL=9": "SET_VELOCITY_LIMIT: ACCEL_TO_DECEL has no effect",
    "M106 X100": "M106 sets speeds, by S",
    "M106 P0 F250": "M106 sets no frequency; the machine file has it",
}


@pytest.mark.parametrize("line", NOTES)
def test_command_without_effect_is_noted_once_a_console(s, line):
    note, ok = s.host.ok(line)
    assert (note.startswith(f"echo:{NOTES[line]}"), ok) == (True, "ok")
    assert s.host.ok(line) == ["ok"]
    assert Host(s).ok(line) == [note, "ok"]


def test_a_frequency_sets_no_speed_of_a_fan(s):
    s.host.ok("M106 S51 F")
    assert s.printer.rig.commands.outputs.fans == {"part": 0.2}
    s.host.ok("M106 P0 F250")
    assert s.printer.rig.commands.outputs.fans == {"part": 0.2}
    s.host.ok("M106 F250 S102")
    assert s.printer.rig.commands.outputs.fans == {"part": 0.4}
    s.host.ok("M106 F")
    assert s.printer.rig.commands.outputs.fans == {"part": 1.0}
    s.passes(1)
    assert s.board.output_value("part") == 1_600_000  # of a cycle of 0.1 s


def test_note_does_not_fail_a_command(s):
    s.host.ok("M932")
    s.host.ok("M907 X500")
    assert s.host.ok("M105")[0].startswith("ok T:")


def test_a_file_reports_its_notes_once(tmp_path):
    (tmp_path / "a.g").write_text("M907 X1\nM907 X2\nM300\n" * 3)
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("^Done printing file$", 5)
        told = [x for x in s.host.heard if "does nothing here" in x]
        assert [x.split()[0] for x in told] == ["echo:M907", "echo:M300"]


def test_a_print_without_consoles_is_warned_of_what_is_not_built(tmp_path, capsys):
    (tmp_path / "a.gcode").write_text("G28\nG29\nG29\nM907 X1\nG1 X10 F6000\n")
    assert main(["print", str(tmp_path / "a.gcode"), "--levelling", "skip"]) == 0
    said = capsys.readouterr()
    assert "a.gcode:2: G29: levelling was skipped (2 times)" in said.out + said.err


@pytest.mark.parametrize("words", ["X100", "L20", "H0", "I1", "U9", "P0 X100 L20", "T50"])
@pytest.mark.parametrize("before", [0, 90])
def test_settings_of_a_fan_leave_its_speed(s, words, before):
    s.host.ok(f"M106 S{before}")
    s.passes(1)
    at = s.board.output_value("part")
    s.host.ok(f"M106 {words}")
    s.passes(1)
    assert s.board.output_value("part") == at
    s.host.ok("M106")
    s.passes(1)
    assert s.board.output_value("part") > at


def test_m106_with_a_setting_and_a_speed_sets_the_speed(s):
    s.host.ok("M106 S128 X255")
    s.passes(1)
    assert s.printer.rig.commands.outputs.fans["part"] == pytest.approx(128 / 255)


def test_m204_v_is_the_travel_acceleration(s):
    s.host.ok("M204 V1234")
    assert s.host.ok("M204")[0] == "M204 P3000 R5000 T1234"
    s.host.ok("M204 V1500 T1700")
    assert s.host.ok("M204")[0].endswith(" T1700")
    with Scenario(config.load_text(shipped_text("i3"))) as fresh:
        fresh.host.ok("M204 P900 V1100")
        assert fresh.host.ok("M204")[0] == "M204 P900 R5000 T1100"


def test_m205_uses_j_and_reports_the_rest(s):
    s.host.ok("M205 X8 J0.05")
    assert s.host.ok("M205")[0] == "M205 J0.05"


def test_m205_sets_the_jerk_where_corners_obey_it():
    text = shipped_text("i3").replace('junction = "deviation"', 'junction = "jerk"')
    with Scenario(config.load_text(text)) as s:
        assert s.host.ok("M205")[0] == "M205 X10 Y10 Z0.4 E1"
        assert s.host.ok("M205 X8 Z0.2 E0.5 Y20 S0") == [
            "echo:M205: Y 20 mm/s is above the machine's limit, 10 mm/s is applied",
            "ok",
        ]
        assert s.host.ok("M205")[0] == "M205 X8 Y10 Z0.2 E0.5"
        assert s.host.ok("M205 J0.05")[0].startswith(
            "echo:M205: J has no effect, because the machine's corners"
        )
        assert "M205 X8 Y10 Z0.2 E0.5" in "\n".join(s.host.ok("M503"))


BEYOND = {
    "M203 X500": (
        "M203: X 500 mm/s is above the machine's limit, 300 mm/s is applied",
        "M203 X300 ",
    ),
    "M203 E400": ("M203: E 400 mm/s is above the machine's limit, 100 mm/s is applied", "E100"),
    "M201 Y9000": (
        "M201: Y 9000 mm/s2 is above the machine's limit, 3000 mm/s2 is applied",
        "Y3000",
    ),
    "M204 P9000": (
        "M204: P 9000 is above the limits of M201, which apply: X 3000, Y 3000",
        "P9000",
    ),
    "M204 R9000": ("M204: R 9000 is above the limits of M201, which apply: E 5000", "R9000"),
    "SET_VELOCITY_LIMIT VELOCITY=900": (
        "SET_VELOCITY_LIMIT: VELOCITY 900 is above the limits of M203, which apply: X 300, Y 300",
        None,
    ),
    "M221 S5000": ("M221: 5000 % is not within 1 to 1000 %, 1000 % is taken", "1000%"),
    "M145 S0 H400": ("M145 H: 400 is not within 0 to 270, 270 is taken", "M145 S0 H270 "),
    "M113 S99": ("M113: 99 s is not within 0 to 60 s, 60 s is taken", "M113 S60"),
    "M106 S300": ("M106 S: 300 is not within 0 to 255, 255 is taken", None),
    "M106 S-5": ("M106 S: -5 is not within 0 to 255, 0 is taken", None),
}


@pytest.mark.parametrize("line", BEYOND)
def test_value_out_of_range_is_answered_with_applied_value(s, line):
    says, holds = BEYOND[line]
    assert s.host.ok(line) == [f"echo:{says}", "ok"]
    if holds is not None:
        assert holds in s.host.ok(line.split()[0])[0]


@pytest.mark.parametrize(
    "line",
    [
        "M203 X300",
        "M201 X3000",
        "M204 P3000 R5000 T3000",
        "M106 S255",
        "M221 S1000",
        "M145 S0 H270",
    ],
)
def test_value_at_its_limit_causes_no_note(s, line):
    assert s.host.ok(line) == ["ok"]


def test_m106_at_most_turns_the_fan_fully_on(s):
    s.host.ok("M106 S255")
    s.passes(0.5)
    full = s.board.output_value("part")
    s.host.ok("M107")
    s.passes(0.5)
    assert s.board.output_value("part") == 0
    s.host.ok("M106 S300")
    s.passes(0.5)
    assert s.board.output_value("part") == full > 0


@pytest.mark.parametrize(
    ("words", "layer"),
    [("L0.2", "0.200,0.240"), ("H16 L0.22", "0.200,0.240"), ("H8 L0.15", "0.140,0.160")],
)
def test_m92_reports_the_heights_of_whole_steps(s, words, layer):
    """400 microsteps a mm: sixteen of them are 0.04 mm."""
    before = s.host.ok("M92")[0]
    (told, ok) = s.host.ok(f"M92 {words}")
    least = "0.020" if "H8" in words else "0.040"
    assert re.fullmatch(
        rf"echo:\{{ micro steps:\d+, minimum layer height:{least}, layer:\[{layer}\] \}}", told
    )
    assert ok == "ok"
    assert s.host.ok("M92")[0] == before
    assert "H is 0" in s.host.ok("M92 H0 L1")[0]


@pytest.mark.parametrize(
    ("machine", "line", "told"),
    [
        ("delta", "M92 X100", "unknown axis X; this machine has E, A, B, C"),
        ("delta", "M203 A100", "unknown axis A; this machine has X, Y, Z"),
        ("i3", "M201 X500 U5", "unknown axis U; this machine has X, Y, Z"),
        ("i3", "M92 X200000", "X is 200000: expected 0.001 to 100,000 microsteps per mm"),
        ("i3", "M220 S5", "echo:M220: 5 % is not within 10 to 1000 %, 10 % is taken"),
        (
            "i3",
            "M305 H0 T5 A100000",
            "echo:M305 sets neither type nor pin; the machine file has them",
        ),
        ("i3", "M301 H0 P20 C5", "echo:M301 adds nothing for extrusion (C, L)"),
        ("i3", "M220 S4000", "echo:M220: 4000 % is not within 10 to 1000 %, 1000 % is taken"),
    ],
)
def test_letters_that_move_nothing_and_limits_are_reported(machine, line, told):
    with Scenario(machine) as s:
        assert told in s.host.ok(line)[0]
        assert s.host.ok("M201")[0].startswith("M201 X")
