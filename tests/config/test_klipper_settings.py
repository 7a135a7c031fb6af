"""The settings of Klipper that macros and clients read: all options, with their types."""

import re

import pytest

from passo import config
from passo.config.exporting.settings import Sections, typed
from passo.config.klipper_options import option_of
from passo.config.klipper_options.left_out import sentences
from passo.config.load import shipped_machines
from passo.config.notes import notes
from passo.errors import ConfigError

MACHINES = shipped_machines()


@pytest.mark.parametrize("name", MACHINES)
def test_table_knows_each_option_of_a_machine(name):
    sections = Sections(config.load(name))
    unknown = [
        f"[{section}] {option}"
        for section, options in sections.texts.items()
        for option in options
        if not option_of(section, option)
    ]
    assert unknown == []
    assert sections.settings.keys() == {section.lower() for section in sections.texts}
    assert all(isinstance(text, str) for own in sections.texts.values() for text in own.values())


def test_settings_have_values_of_the_machine_and_klippers_defaults():
    settings = Sections(config.load("voron-2-4")).settings
    assert settings["pause_resume"] == {"recover_velocity": 50.0}
    assert settings["idle_timeout"]["timeout"] == 600.0
    extruder = settings["extruder"]
    assert extruder["max_extrude_cross_section"] == pytest.approx(4 * 0.4**2)
    assert (extruder["min_temp"], extruder["max_temp"]) == (5.0, 270.0)
    assert (extruder["gear_ratio"], extruder["full_steps_per_rotation"]) == ((), 200)
    z = settings["stepper_z"]
    assert z["homing_speed"] == z["homing_retract_speed"] == 8
    assert z["homing_positive_dir"] is False
    # the further motors of Z have no endstop, so they do not home by themselves
    assert {"homing_speed", "second_homing_speed", "position_max"}.isdisjoint(
        settings["stepper_z1"]
    )
    mesh = settings["bed_mesh"]
    assert (mesh["mesh_min"], mesh["mesh_max"]) == ((40.0, 40.0), (210.0, 210.0))
    assert (mesh["probe_count"], mesh["mesh_pps"], mesh["fade_end"]) == ((5, 5), (2, 2), 0.0)
    gantry = settings["quad_gantry_level"]
    assert gantry["gantry_corners"] == ((-60.0, -10.0), (310.0, 320.0))
    assert (gantry["horizontal_move_z"], gantry["retries"]) == (5.0, 5)
    driver = settings["tmc2209 stepper_x"]
    assert (driver["driver_toff"], driver["driver_pwm_autoscale"]) == (3, True)
    fan = settings["controller_fan board"]
    assert (fan["stepper"], fan["heater"]) == (("stepper_x", "stepper_y"), ("extruder",))


@pytest.mark.parametrize(
    ("section", "written", "expected"),
    [
        ("stepper_x", {"position_endstop": "0", "position_max": "200"}, {"position_min": 0.0}),
        (
            "stepper_y",
            {"position_endstop": "200", "position_max": "200", "homing_speed": "50"},
            {"homing_positive_dir": True, "second_homing_speed": 25.0, "homing_speed": 50.0},
        ),
        (
            "stepper_z2",
            {"step_pin": "PA1", "gear_ratio": "80:16, 2:1"},
            {"gear_ratio": ((80.0, 16.0), (2.0, 1.0))},
        ),
        ("probe", {"speed": "3"}, {"lift_speed": 3.0, "samples_result": "average"}),
        ("heater_bed", {"sensor_type": "PT1000"}, {"pullup_resistor": 4700.0}),
        ("heater_bed", {"sensor_type": "MAX31865"}, {"rtd_reference_r": 430.0}),
        ("extruder", {"nozzle_diameter": "0.6"}, {"max_extrude_cross_section": 1.44}),
        ("screws_tilt_adjust", {"screw2": "5, 10"}, {"screw2": (5.0, 10.0), "speed": 50.0}),
        ("input_shaper", {"shaper_freq_x": "40"}, {"shaper_type_y": "mzv", "shaper_freq_x": 40.0}),
        ("gcode_macro A", {"gcode": "G28", "variable_t": "3"}, {"variable_t": "3"}),
        ("bed_mesh", {"mesh_radius": "50"}, {"round_probe_count": 5, "mesh_origin": (0.0, 0.0)}),
    ],
)
def test_options_depend_on_others_of_their_section(section, written, expected):
    found = typed(section, written)
    assert {name: found[name] for name in expected} == {
        name: pytest.approx(value) if isinstance(value, float) else value
        for name, value in expected.items()
    }
    assert [type(found[name]) for name in expected] == [type(v) for v in expected.values()]


def test_options_of_other_sensors_have_no_value():
    assert "pullup_resistor" not in typed("heater_bed", {"sensor_type": "MAX31855"})
    assert "tc_type" not in typed("heater_bed", {"sensor_type": "MAX31855"})
    assert "position_max" not in typed("stepper_z1", {"step_pin": "PA1"})


def test_kept_options_are_read_by_macros_and_exported():
    kept = '[klipper.extruder]\nnozzle_diameter = "0.6"\nmax_extrude_cross_section = "5"\n'
    kept += 'max_temp = "999"\n[klipper.pause_resume]\nrecover_velocity = "25"\n'
    sections = Sections(config.load_text(config.shipped_text("i3") + kept, "mine.toml"))
    extruder = sections.settings["extruder"]
    assert (extruder["nozzle_diameter"], extruder["max_extrude_cross_section"]) == (0.6, 5.0)
    assert extruder["max_temp"] == 285.0  # the machine's own value
    assert sections.settings["pause_resume"]["recover_velocity"] == 25.0
    assert sections.texts["pause_resume"] == {"recover_velocity": "25"}


@pytest.mark.parametrize(
    ("kept", "told"),
    [
        ('[klipper.extruder]\nnozzle_diameter = "wide"', "'wide': expected a number"),
        ('[klipper.extruder]\ncolour = "red"', "expected an option that Klipper has in [extruder]"),
        ('[klipper.""]\na = "1"', "expected the name of a section of Klipper"),
    ],
)
def test_kept_options_that_macros_cannot_read_are_errors(kept, told):
    with pytest.raises(ConfigError, match=re.escape(told)):
        config.load_text(f"{config.shipped_text('i3')}{kept}\n", "mine.toml")


LEFT_OUT = """
[klipper."output_pin Lamp"]
value = "0.5"
[klipper."filament_switch_sensor roll"]
switch_pin = "PA1"
[klipper."tmc2240 stepper_x"]
run_current = "0.8"
[klipper.motors_sync]
axes = "x,y"
[klipper.heater_bed]
smooth_time = "2"
"""


def test_parts_that_are_left_out_keep_their_settings_for_macros():
    machine = config.load_text(config.shipped_text("i3") + LEFT_OUT, "mine.toml")
    sections = Sections(machine)
    assert [*sections.left_out] == [
        "output_pin Lamp",
        "filament_switch_sensor roll",
        "tmc2240 stepper_x",
        "motors_sync",
    ]
    assert sections.settings["output_pin lamp"]["value"] == 0.5
    assert sections.settings["filament_switch_sensor roll"]["pause_on_runout"] is True
    assert sections.settings["tmc2240 stepper_x"]["rref"] == 12000.0
    assert sections.settings["motors_sync"] == {"axes": "x,y"}
    told = [note for note in notes(machine) if "does not drive this part" in note]
    assert [note.partition(" macros read ")[2].partition(",")[0] for note in told] == [
        "the value that SET_PIN has given it",
        "that there is filament",
        "its settings and no state",
    ]


def test_many_parts_of_one_kind_are_counted_in_a_note():
    names = ["led_effect a", "led_effect b", "led_effect c", "motors_sync", "led_effect d"]
    assert sentences(names) == [
        "of 4 sections [led_effect …], motors_sync macros read its settings and no state"
    ]
