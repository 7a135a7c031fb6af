"""Klipper's filament sensors and buttons become those of a machine file, and back."""

from pathlib import Path

import pytest
from tests.config.test_import_klipper import BASE
from tests.support.filament_printer import with_inputs
from tests.support.import_remarks import remarks

from passo import config
from passo.config.exporting.klipper import sections_of
from passo.config.importing.formats import imported
from passo.config.inputs import FilamentSensor
from passo.errors import ConfigError


@pytest.fixture
def load(tmp_path: Path):
    def convert(more: str):
        path = tmp_path / "printer.cfg"
        path.write_text(BASE + more, encoding="utf-8")
        draft = imported(path)
        return draft, config.load_text(draft.text("From a test."), "printer.toml")

    return convert


SWITCH = """[filament_switch_sensor Roll]
switch_pin: ^!PC13
pause_on_runout: {}
runout_gcode: {}
"""


def test_switch_becomes_a_sensor_with_its_templates(load):
    more = "insert_gcode:\n  M117 in\nevent_delay: 1.5\npause_delay: 0.5\n"
    draft, machine = load(SWITCH.format("False", "M117 out") + more)
    assert machine.filament_sensors == {
        "Roll": FilamentSensor(
            pin="!^PC13",
            on_runout="none",
            runout_gcode="M117 out",
            insert_gcode="M117 in",
            event_delay_s=1.5,
        )
    }
    assert not [r for r in draft.remarks if "Roll" in r.what]
    shown = sections_of(machine)["filament_switch_sensor Roll"]
    assert shown["switch_pin"] == "^!PC13"
    assert (shown["pause_on_runout"], shown["event_delay"]) == ("False", "1.5")


@pytest.mark.parametrize(
    ("pauses", "gcode", "macros", "becomes"),
    [
        ("True", "PAUSE", "", ("pause", "")),
        ("False", "M600", "", ("pause", "")),
        ("True", "M600", "[gcode_macro M600]\ngcode: PAUSE\n", ("pause", "M600")),
        ("True", "M117 out", "", ("pause", "M117 out")),
    ],
)
def test_lone_pause_of_a_runout_becomes_the_pause(load, pauses, gcode, macros, becomes):
    _, machine = load(SWITCH.format(pauses, gcode) + macros)
    sensor = machine.filament_sensors["Roll"]
    assert (sensor.on_runout, sensor.runout_gcode) == becomes


def test_motion_sensor_has_its_extruder_and_length(load):
    text = "[filament_motion_sensor Roll]\nswitch_pin: PC14\nextruder: {}\ndetection_length: 3\n"
    _, machine = load(SWITCH.format("True", "") + text.format("extruder"))
    assert machine.filament_sensors["Roll_motion"] == FilamentSensor(
        kind="motion", pin="PC14", extruder="e", length_mm=3.0
    )


def test_motion_sensor_of_no_extruder_is_left_out(load):
    text = "[filament_motion_sensor Roll]\nswitch_pin: PC13\nextruder: extruder4\n"
    draft, machine = load(text)
    assert machine.filament_sensors == {}
    assert "the sensor is left out" in remarks(draft, "decide")[0]


def test_button_becomes_a_button(load):
    text = "[gcode_button stop]\npin: ^PC13\npress_gcode:\n  M112\ndebounce_delay: 0.02\n"
    _, machine = load(text)
    button = machine.buttons["stop"]
    assert (button.pin, button.press_gcode, button.debounce_s) == ("^PC13", "M112", 0.02)
    assert sections_of(machine)["gcode_button stop"]["press_gcode"].strip() == "M112"


def test_sensor_on_a_pin_of_another_part_is_left_out(load):
    draft, machine = load(SWITCH.format("True", "").replace("PC13", "PB4"))
    assert machine.filament_sensors == {}
    assert "PB4 belongs to steppers.e" in remarks(draft, "decide")[0]


ANALOG = "[gcode_button {}]\npin: {}\nanalog_range: {}\npress_gcode: M117 up\n"


def test_analog_buttons_share_a_pin_by_their_resistances(load):
    up, down = ANALOG.format("up", "PC0", "0, 100"), ANALOG.format("down", "PC0", "100, 300")
    draft, machine = load(up + "analog_pullup_resistor: 10000\n" + down.replace("PC0", "PC1"))
    assert machine.buttons["up"].resistance_ohm == [0, 100]
    assert machine.buttons["up"].shares == (0.0, pytest.approx(100 / 10100))
    assert machine.buttons["down"].pull_up_ohm == 4700
    assert not [r for r in draft.remarks if "gcode_button" in r.what]
    shown = sections_of(machine)["gcode_button up"]
    assert (shown["analog_range"], shown["analog_pullup_resistor"]) == ("0, 100", "10000")
    assert list(load(up + down)[1].buttons) == ["up", "down"]


@pytest.mark.parametrize(
    ("pin", "ohm", "more", "problem"),
    [
        ("PB4", "100, 300", "", "PB4 belongs to steppers.e"),
        ("PC0", "99, 300", "", "overlaps"),
        ("PC0", "300, 100", "", "higher maximum"),
        ("PC0", "100, 300", "analog_pullup_resistor: 10000\n", "same pin"),
    ],
)
def test_analog_button_that_cannot_work_is_left_out(load, pin, ohm, more, problem):
    up, down = ANALOG.format("up", "PC0", "0, 100"), ANALOG.format("down", pin, ohm)
    draft, machine = load(up + down + more)
    assert list(machine.buttons) == ["up"]
    assert problem in "\n".join(remarks(draft, "decide"))


HALL = """[hall_filament_width_sensor]
adc1: PC0
adc2: PA4
Cal_dia1: 1.48
Raw_dia1: 9000
default_nominal_filament_diameter: 1.75
measurement_delay: 70
enable: True
pause_on_runout: False
runout_gcode: M117 out
"""


def test_hall_sensor_of_the_width_becomes_a_sensor(load):
    draft, machine = load(HALL)
    sensor = machine.filament_sensors["hall_filament_width_sensor"]
    assert (sensor.kind, sensor.pin, sensor.on_runout) == ("width", "PC0", "none")
    assert sensor.width is not None
    assert sensor.width.second_pin == "PA4"
    assert (sensor.width.readings, sensor.width.diameters_mm) == ([9000, 10500], [1.48, 2.0])
    assert (sensor.width.distance_mm, sensor.width.interval_mm) == (70, 10)
    assert sensor.width.diameter_mm(9500) == pytest.approx(1.48 + 0.52 / 3)
    assert not [r for r in draft.remarks if "hall" in r.what]
    shown = sections_of(machine)["hall_filament_width_sensor"]
    assert (shown["adc2"], shown["raw_dia1"], shown["enable"]) == ("PA4", "9000", "True")


def test_linear_sensor_of_the_width_has_5_mm_at_full_scale(load):
    text = "[tsl1401cl_filament_width_sensor]\npin: PC0\nmax_difference: 0.3\n"
    keys = "default_nominal_filament_diameter: 2.85\nmeasurement_delay: 100\n"
    _, machine = load(text + keys)
    width = machine.filament_sensors["tsl1401cl_filament_width_sensor"].width
    assert width is not None
    assert (width.diameter_mm(5700), width.reading(2.85)) == (2.85, 5700)
    assert (width.nominal_mm, width.max_difference_mm) == (2.85, 0.3)
    assert sections_of(machine)["tsl1401cl_filament_width_sensor"]["pin"] == "PC0"


def test_width_sensor_needs_its_measurement():
    table = '[filament_sensors.w]\nkind = "width"\npin = "A11"\n'
    with pytest.raises(ConfigError, match="both kind"):
        with_inputs(table)
    width = "[filament_sensors.{}.width]\ndistance_mm = 9.0\n"
    with pytest.raises(ConfigError, match="two different values"):
        with_inputs(table + width.format("w") + "readings = [1, 1]\n")
    other = table.replace(".w]", ".v]").replace("A11", "A12")
    with pytest.raises(ConfigError, match="at most one sensor of the width"):
        with_inputs(table + width.format("w") + other + width.format("v"))
