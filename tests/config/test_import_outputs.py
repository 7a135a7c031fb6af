"""Outputs of a printer.cfg, and sensors that no heater uses."""

from pathlib import Path

import pytest
from tests.config.test_import_klipper import BASE
from tests.support.import_remarks import remarks

from passo import config
from passo.config.exporting.settings import Sections
from passo.config.importing.formats import imported
from passo.config.importing.settling import settle

PARTS = """
[output_pin caselight]
pin: !PC6
pwm: True
cycle_time: 0.01
value: 50
shutdown_value: 100
scale: 100
[output_pin Power Relay]
pin: PC7
value: 1
[pwm_tool spindle]
pin: PC8
hardware_pwm: True
cycle_time: 0.001
maximum_mcu_duration: 2
[static_digital_output levels]
pins: PC10, !PC11
[temperature_sensor chamber]
sensor_type: Generic 3950
sensor_pin: PC1
min_temp: 0
max_temp: 90
gcode_id: C
[temperature_sensor pi]
sensor_type: temperature_host
gcode_id: C
[temperature_sensor mcu]
sensor_type: temperature_mcu
max_temp: 100
gcode_id: MCU
[temperature_fan cpu]
pin: PB0
sensor_type: temperature_mcu
max_temp: 90
control: pid
pid_Kp: 40
pid_Ki: 0.5
pid_Kd: 2
target_temp: 55
max_speed: 0.8
[controller_fan case]
pin: PB1
idle_speed: 0.4
[temperature_sensor air]
sensor_type: BME280
i2c_bus: i2c1
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory):
    """The draft of BASE with PARTS, and its machine."""
    path: Path = tmp_path_factory.mktemp("outputs") / "printer.cfg"
    path.write_text(BASE + PARTS, encoding="utf-8")
    draft = imported(path)
    settle(draft)
    return draft, config.load_text(draft.text("From a test."), "printer.toml")


def test_outputs_keep_their_pins_values_and_scale(made):
    outputs = made[1].outputs
    light, relay, spindle = (outputs[n] for n in ("caselight", "Power_Relay", "spindle"))
    assert (light.pin, light.pwm, light.pwm_hz) == ("!PC6", "software", 100.0)
    assert (light.start, light.at_halt, light.scale, light.use) == (0.5, 1.0, 100.0, "light")
    assert (relay.pin, relay.pwm, relay.start, relay.use) == ("PC7", "none", 1.0, None)
    assert (spindle.pwm, spindle.pwm_hz, spindle.max_on_s) == ("hardware", 1000.0, 2.0)


def test_static_outputs_are_fixed_also_while_the_board_is_halted(made):
    first, second = (made[1].outputs[n] for n in ("levels", "levels_2"))
    assert [(o.pin, o.start, o.at_halt, o.fixed) for o in (first, second)] == [
        ("PC10", 1.0, 1.0, True),
        ("!PC11", 1.0, 1.0, True),
    ]


def test_sensors_keep_kind_range_and_letter(made):
    chamber, pi, mcu = (made[1].sensors[n] for n in ("chamber", "pi", "mcu"))
    assert (chamber.sensor_pin, chamber.min_c, chamber.max_c) == ("PC1", 0.0, 90.0)
    assert (chamber.letter, chamber.on_fault) == ("C", "machine")
    assert [s.sensor.kind for s in (chamber, pi, mcu)] == ["thermistor", "host", "chip"]
    assert (pi.on_fault, mcu.on_fault, mcu.max_c) == ("report", "machine", 100.0)
    assert (pi.letter, mcu.letter) == (None, None)
    assert "it belongs to chamber" in "\n".join(remarks(made[0], "dropped"))
    assert "[temperature_sensor mcu] gcode_id: M105" in "\n".join(remarks(made[0], "changed"))


def test_fans_keep_what_they_follow(made):
    cpu, case = (made[1].fans[n] for n in ("cpu", "case"))
    kept = cpu.thermostat
    assert (kept.sensor, kept.target_c, kept.kp, kept.ki, kept.kd) == ("cpu", 55.0, 40.0, 0.5, 2.0)
    assert (kept.min_power, cpu.max_power) == (0.3, 0.8)
    assert made[1].sensors["cpu"].sensor.kind == "chip"
    assert (case.follows_targets, case.idle_power, case.stays_on_s) == (["hotend"], 0.4, 30.0)


def test_sensor_that_passo_cannot_read_is_left_out_with_the_reason(made):
    draft, machine = made
    assert "air" not in machine.sensors
    assert "sensor_type in [temperature_sensor air] is 'BME280'" in "\n".join(
        remarks(draft, "decide")
    )


def test_clients_see_the_sections_of_outputs_and_sensors(made):
    settings = Sections(made[1]).settings
    light = settings["output_pin caselight"]
    assert (light["pwm"], light["scale"], light["value"]) == (True, 100.0, 50.0)
    assert settings["static_digital_output levels_2"]["pins"] == ("!PC11",)
    assert settings["temperature_sensor mcu"]["sensor_type"] == "temperature_mcu"
    assert settings["temperature_sensor chamber"]["gcode_id"] == "C"
