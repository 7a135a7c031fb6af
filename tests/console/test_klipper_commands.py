"""Klipper's commands on consoles and in files, as clients and slicers send them."""

import pytest
from tests.support.scenario import Scenario

import passo
from passo import config
from passo.config.part_names import found_name


def send(s, *lines):
    for line in lines:
        s.host.ok(line)


def position(s):
    return s.host.ok("M114")[0].split(" Count")[0]


def test_jog_of_a_page_leaves_modes_and_feedrate_as_they_were():
    with Scenario("i3") as s:
        send(s, "G28", "G90", "G1 X50 Y50 Z10 F3000")
        for line in ("SAVE_GCODE_STATE NAME=_ui_movement", "G91", "G1 X+10 F6000"):
            s.host.ok(line)
        send(s, "RESTORE_GCODE_STATE NAME=_ui_movement", "G1 Y60")
        assert s.printer.rig.job.modes.now == (True, True, 50.0)
        assert position(s).startswith("X:60.000 Y:60.000 Z:10.000")


def test_jog_of_a_page_is_in_mm_while_the_program_counts_inches():
    with Scenario("i3") as s:
        send(s, "G28", "G90", "G1 X50 Y50 Z10 F3000", "G20")
        send(s, "SAVE_GCODE_STATE NAME=_ui_movement", "G91", "G1 X+10 F6000")
        s.host.ok("RESTORE_GCODE_STATE NAME=_ui_movement")
        assert s.printer.rig.job.machine_position[0] == pytest.approx(60)
        send(s, "SAVE_GCODE_STATE NAME=mine", "G1 X1 F100")
        assert s.printer.rig.job.machine_position[0] == pytest.approx(25.4)


def test_restored_state_counts_filament_and_factors_from_where_it_was():
    with Scenario("i3") as s:
        send(s, "G28", "M302 S0", "M82", "G1 E5 F300", "M220 S80", "SAVE_GCODE_STATE")
        send(s, "M83", "G1 E7", "M220 S150", "M221 S50", "G1 Z5", "RESTORE_GCODE_STATE")
        assert "E:5.0000" in position(s)
        assert (s.printer.rig.job.limits.speed_factor, s.printer.rig.job.filament.flows) == (
            0.8,
            [1.0],
        )
        s.host.ok("G1 E6")  # absolute again: 1 mm
        assert "E:6.0000" in position(s)


def test_restore_with_move_returns_to_the_saved_place():
    with Scenario("i3") as s:
        send(s, "G28", "G1 X20 Y30 Z10 F3000", "SAVE_GCODE_STATE NAME=a", "G91", "G1 X5 Y5 Z5")
        s.host.ok("RESTORE_GCODE_STATE NAME=a MOVE=1 MOVE_SPEED=50")
        assert position(s).startswith("X:20.000 Y:30.000 Z:10.000")


def test_babysteps_survive_a_restored_state():
    with Scenario("i3") as s:
        send(s, "G28", "G1 Z10 F600", "SAVE_GCODE_STATE NAME=a", "SET_GCODE_OFFSET Z_ADJUST=0.05")
        send(s, "SET_GCODE_OFFSET Z_ADJUST=0.05 MOVE=1", "RESTORE_GCODE_STATE NAME=a")
        assert s.printer.motion.offsets.babysteps_mm["z"] == pytest.approx(0.1)
        s.host.ok("SET_GCODE_OFFSET Z=0.02")
        assert s.printer.motion.offsets.babysteps_mm["z"] == pytest.approx(0.02)
        assert s.printer.rig.job.machine_position[2] == pytest.approx(10.02)


def test_gcode_offset_stays_when_axes_home():
    """As in Klipper, also an offset that is set before. Babysteps of M290 end, as in Marlin."""
    with Scenario("i3") as s:
        send(s, "SET_GCODE_OFFSET Z=0.2 X=1", "SET_GCODE_OFFSET Z_ADJUST=-0.05", "G28")
        assert s.printer.motion.offsets.babysteps_mm == {
            "x": 1.0,
            "y": 0.0,
            "z": pytest.approx(0.15),
        }
        send(s, "M290 Z0.3", "G28 Z", "G1 X20 Z10 F6000", "M400")
        assert position(s).startswith("X:20.000 Y:0.000 Z:10.000")
        assert s.printer.rig.job.machine_position[0] == pytest.approx(21)
        assert s.printer.rig.job.machine_position[2] == pytest.approx(10.15)
        send(s, "SET_GCODE_OFFSET Z=0", "G28", "G1 Z10 F600", "M400")
        assert s.printer.rig.job.machine_position[2] == pytest.approx(10)


def test_gcode_offset_that_became_part_of_z_ends():
    with Scenario("i3") as s:
        send(s, "G28", "G1 Z10 F600", "SET_GCODE_OFFSET Z=0.1", "Z_OFFSET_APPLY_ENDSTOP")
        assert s.printer.motion.offsets.babysteps_mm["z"] == 0
        send(s, "G28", "G1 Z10 F600", "M400")
        assert s.printer.rig.job.machine_position[2] == pytest.approx(10)
        s.host.ok("SET_GCODE_OFFSET Z=0.1")
        s.host.send("M112").expect("Printer halted")
        s.host.ok("M999")
        send(s, "G28", "G1 Z10 F600", "M400")
        assert s.printer.rig.job.machine_position[2] == pytest.approx(10)


def test_gcode_offset_at_a_limit_acts_on_the_next_move():
    """Nothing moves below the end of Z, where the machine is after G28."""
    with Scenario("i3") as s:
        send(s, "G28", "SET_GCODE_OFFSET Z=-0.1", "M400")
        assert s.printer.rig.job.machine_position[2] == pytest.approx(0)
        assert s.printer.motion.offsets.babysteps_mm["z"] == pytest.approx(-0.1)
        send(s, "G1 Z10 F600", "M400")
        assert s.printer.rig.job.machine_position[2] == pytest.approx(9.9)
        assert "at most 2 mm" in s.host.ok("SET_GCODE_OFFSET Z=-3")[0]


def test_gcode_offset_of_a_file_stays_when_axes_home(tmp_path):
    file = tmp_path / "a.gcode"
    lines = ["SET_GCODE_OFFSET Z=-0.2", "G28", "SET_GCODE_OFFSET Z_ADJUST=0.5", "G28 Z", "G1 Z10"]
    file.write_text("\n".join(lines) + "\n")
    machine = passo.Machine.load("i3")
    assert machine.print(str(file)).final_position_mm["z"] == pytest.approx(10.3)
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M23 a.gcode")
        s.host.ok("M24")
        s.host.expect("Done printing file", 120)
        assert s.printer.rig.job.machine_position[2] == pytest.approx(10.3)


def test_heaters_and_fans_are_set_by_klippers_names():
    with Scenario("i3") as s:
        s.host.ok('SET_HEATER_TEMPERATURE HEATER="extruder" TARGET=200')
        s.host.ok("set_heater_temperature heater='heater_bed' target=50")
        send(s, "SET_FAN_SPEED FAN=fan SPEED=0.5", "M400")
        heaters = s.printer.rig.connection.heaters
        assert {name: heater.target for name, heater in heaters.items()} == {
            "hotend": 200.0,
            "bed": 50.0,
        }
        assert s.printer.rig.commands.outputs.fans == {"part": 0.5}
        send(s, "TURN_OFF_HEATERS", "M400")
        assert [heater.target for heater in heaters.values()] == [0.0, 0.0]


def test_parts_are_found_by_the_names_of_a_printer_cfg():
    """Klipper's whole name of a heater, and blanks where names of parts have _."""
    assert found_name(["heater_fan Hotend_Fan", "fan"], "heater_fan hotend fan") is not None
    assert found_name(["a_b", "a-b"], "A b") == "a_b"
    assert found_name(["a_b", "A_B"], "a b") is None
    assert found_name(["part", "_"], "") is None
    chamber = (
        config.shipped_text("i3")
        .replace("[heaters.bed]", "[heaters.box]")
        .replace('kind = "bed"', 'kind = "chamber"')
    )
    with Scenario(config.load_text(chamber, "i3.toml")) as s:
        send(s, 'SET_HEATER_TEMPERATURE HEATER="heater_generic box" TARGET=40', "M400")
        assert s.printer.rig.connection.heaters["box"].target == 40


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("SET_HEATER_TEMPERATURE HEATER=oven TARGET=1", "HEATER is oven: expected extruder, heat"),
        ("SET_HEATER_TEMPERATURE TARGET=1", "HEATER is missing"),
        ("SET_HEATER_TEMPERATURE HEATER=extruder TARGET=hot", "'TARGET=hot' has no valid number"),
        ("SET_FAN_SPEED FAN=case SPEED=1", "FAN is case: expected fan"),
        ("RESTORE_GCODE_STATE NAME=b", "NAME is b: expected a name that SAVE_GCODE_STATE"),
        ("PID_CALIBRATE HEATER=extruder", "needs TARGET="),
        ("RESPOND TYPE=shout MSG=a", "TYPE is shout: expected echo, error, command"),
    ],
)
def test_what_is_wrong_with_a_parameter_is_named(line, reason):
    with Scenario("i3") as s:
        assert any(reason in text for text in s.host.ok(line))


def test_wait_for_a_temperature_ends_within_its_limits():
    with Scenario("i3") as s:
        s.host.ok("M104 S100 F")
        s.host.ok("TEMPERATURE_WAIT SENSOR=extruder MINIMUM=60", within=60)
        assert 60 <= s.printer.rig.connection.heaters["hotend"].celsius < 70
        s.host.ok("M104 S0 F")
        s.host.ok("TEMPERATURE_WAIT SENSOR=extruder MAXIMUM=50", within=300)
        assert 45 < s.printer.rig.connection.heaters["hotend"].celsius <= 50


def test_lines_for_pages_have_klippers_prefixes():
    with Scenario("i3") as s:
        assert "// action:prompt_end" in s.host.ok('RESPOND TYPE=command MSG="action:prompt_end"')
        assert "echo: a b" in s.host.ok('RESPOND MSG="a b"')
        assert "echo: a b" in s.host.ok("ECHO a b")


def test_files_may_use_klippers_commands_without_a_console(tmp_path):
    lines = [
        *("SET_HEATER_TEMPERATURE HEATER=extruder TARGET=200", "G28", "G90", "G1 X10 Y10 Z5 F6000"),
        *("SAVE_GCODE_STATE NAME=a", "G91", "G1 X10", "RESTORE_GCODE_STATE NAME=a", "G1 Y20"),
        *("SET_GCODE_OFFSET Z=0.1", "SET_GCODE_OFFSET Z=0.1", "TURN_OFF_HEATERS"),
    ]
    file = tmp_path / "a.gcode"
    file.write_text("\n".join(lines) + "\n")
    result = passo.Machine.load("i3").print(str(file))
    assert not result.warnings


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ('RESPOND MSG="a (b) c ; d" ; comment', "a (b) c ; d"),
        ("RESPOND MSG='x (y); z'", "x (y); z"),
        (r'respond PREFIX="(1)" MSG="say \"(so);\"" ; not', '(1) say "(so);"'),
        ("RESPOND MSG=don't ; not", "don't"),
    ],
)
def test_quoted_value_is_not_a_comment(tmp_path, line, text):
    (tmp_path / "a.g").write_text(f"{line}\n")
    expected = text if text.startswith("(1)") else f"echo: {text}"
    with Scenario("i3", card=str(tmp_path)) as s:
        assert s.host.ok(line)[0] == expected
        s.host.heard.clear()
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 60)
        assert expected in s.host.heard
