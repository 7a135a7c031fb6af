"""Klipper's filament sensors and buttons become those of a machine file, and back."""

from pathlib import Path

import pytest
from tests.config.test_import_klipper import BASE
from tests.support.import_remarks import remarks

from passo import config
from passo.config.exporting.klipper import sections_of
from passo.config.importing.formats import imported
from passo.config.inputs import FilamentSensor


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


def test_analog_buttons_are_left_out(load):
    button = "[gcode_button {}]\npin: PC13\nanalog_range: {}\npress_gcode: M117 up\n"
    draft, machine = load(button.format("up", "0, 100") + button.format("down", "100, 300"))
    assert machine.buttons == {}
    text = "the button is left out: Passo reads no analog buttons"
    assert [r.text for r in draft.remarks if "gcode_button" in r.what] == [text] * 2
