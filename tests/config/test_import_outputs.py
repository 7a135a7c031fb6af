"""Outputs of a printer.cfg, and sensors that no heater uses."""

from pathlib import Path

import pytest
from tests.config.test_import_klipper import BASE
from tests.support.import_remarks import remarks
from tests.support.scenario import Scenario

from passo import config
from passo.config.exporting.klipper import exported
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
[temperature_sensor warmest]
sensor_type: temperature_combined
sensor_list: temperature_sensor chamber, extruder
combination_method: max
maximum_deviation: 100
[heater_fan shared]
pin: PB13
heater: extruder, heater_bed
[temperature_sensor air]
sensor_type: AHT2X
i2c_bus: i2c1
i2c_speed: 50000
aht10_report_time: 30
[temperature_sensor wire]
sensor_type: DS18B20
serial_no: 28-031674b175ff
[temperature_sensor astray]
sensor_type: LM75
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
    warmest = made[1].sensors["warmest"].sensor
    assert (warmest.kind, warmest.of, warmest.by) == ("combined", ["chamber", "hotend"], "max")
    assert (warmest.max_deviation_c, made[1].sensors["warmest"].on_fault) == (100.0, "machine")
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
    shared = made[1].fans["shared"]
    assert (shared.follows, shared.follows_heaters) == ("hotend", ["bed"])
    assert (case.follows_targets, case.idle_power, case.stays_on_s) == (["hotend"], 0.4, 30.0)


def test_sensor_that_passo_cannot_read_is_left_out_with_the_reason(made):
    draft, machine = made
    assert machine.sensors.keys().isdisjoint({"wire", "astray"})
    told = "\n".join(remarks(draft, "decide"))
    assert "sensor_type in [temperature_sensor wire] is 'DS18B20'" in told
    assert "i2c_bus in [temperature_sensor astray] is missing" in told


def test_chip_on_i2c_keeps_its_bus_and_period(made):
    air = made[1].sensors["air"].sensor
    assert (air.kind, air.i2c_bus, air.used_address) == ("aht2x", "i2c1", 56)
    assert (air.i2c_hz, air.period_s) == (50_000, 30.0)
    settings = Sections(made[1]).settings["temperature_sensor air"]
    assert settings["sensor_type"] == "AHT2X"
    assert "i2c_bus: i2c1\ni2c_speed: 50000\n" in exported(made[1]).text("")


def test_clients_see_the_sections_of_outputs_and_sensors(made):
    settings = Sections(made[1]).settings
    light = settings["output_pin caselight"]
    assert (light["pwm"], light["scale"], light["value"]) == (True, 100.0, 50.0)
    assert settings["static_digital_output levels_2"]["pins"] == ("!PC11",)
    assert settings["temperature_sensor mcu"]["sensor_type"] == "temperature_mcu"
    assert settings["temperature_sensor chamber"]["gcode_id"] == "C"
    text = exported(made[1]).text("")
    assert "sensor_list: temperature_sensor chamber, extruder\ncombination_method: max\n" in text
    assert "maximum_deviation: 100\n" in text
    assert "[heater_fan shared]\nheater: extruder, heater_bed\n" in text


JOINED = """
[multi_pin bed_pads]
pins: PC6, !PC7
[multi_pin blowers]
pins: PC8, PC9, PB0
[multi_pin apart]
pins: PB1, other:PB1
[multi_pin spare]
pins: PB2
[mcu other]
serial: /tmp/other
[fan_generic both]
pin: multi_pin:blowers
[output_pin two]
pin: !multi_pin:bed_pads
[output_pin far]
pin: multi_pin:apart
[output_pin BEEPER_pin]
pin: PB10
pwm: True
[gcode_macro M300]
gcode:
  SET_PIN PIN=BEEPER_pin VALUE=1
  G4 P{params.P|default(100)}
  SET_PIN PIN=BEEPER_pin VALUE=0
[gcode_macro CHIRP]
gcode:
  SET_PIN PIN=BEEPER_pin VALUE=1
"""


def test_several_pins_of_one_output_are_further_pins(tmp_path: Path) -> None:
    path = tmp_path / "printer.cfg"
    path.write_text(BASE + JOINED)
    draft = imported(path)
    settle(draft)
    machine = config.load_text(draft.text(""), "x.toml")
    fan, two = machine.fans["both"], machine.outputs["two"]
    assert (fan.pin, fan.further_pins) == ("PC8", ["PC9", "PB0"])
    assert (two.pin, two.further_pins) == ("!PC6", ["PC7"])
    told = "\n".join(remarks(draft, "decide"))
    assert "pin in [output_pin far] is 'multi_pin:apart': expected pins of one board" in told
    assert "far" not in machine.outputs
    dropped = "\n".join(remarks(draft, "dropped"))
    assert "[multi_pin spare]: no output that Passo drives has these pins" in dropped
    assert "blowers" not in dropped
    text = exported(machine).text("")
    assert "[multi_pin both-fan]\npins: PC8, PC9, PB0\n" in text
    assert "pin: multi_pin:two-output\n" in text


def test_output_named_beeper_sounds_at_m300(tmp_path: Path) -> None:
    path = tmp_path / "printer.cfg"
    path.write_text(BASE + JOINED)
    draft = imported(path)
    settle(draft)
    machine = config.load_text(draft.text(""), "x.toml")
    assert machine.beeper is not None
    assert (machine.beeper.pin, [*machine.macros]) == ("PB10", ["CHIRP"])
    assert "sounds at M300 without a macro" in "\n".join(remarks(draft, "changed"))
    with Scenario(config.on_simulated_boards(machine)) as s:
        s.passes(1)
        s.board.trace_output("beeper")
        assert s.host.ok("M300 S1000 P200")[-1] == "ok"
        s.passes(1)
        assert s.board.take_changes("beeper")
        assert s.host.ok("CHIRP")[-1] == "ok"


LIGHTS = """
[neopixel toolhead]
pin: PC12
chain_count: 3
color_order: GRBW
initial_RED: 0.1
initial_WHITE: 0.5
[neopixel mixed]
pin: PC13
chain_count: 2
color_order: GRB, RGBW
[led chamber]
white_pin: !PC14
cycle_time: 0.005
[dotstar bar]
data_pin: PC15
clock_pin: PE0
chain_count: 10
[pca9533 old]
i2c_software_scl_pin: PE1
i2c_software_sda_pin: PE2
"""
TEMPLATES = """
[display_template glow]
param_least: 0.25
param_name: "nozzle"
text:
    {% set share = printer.extruder.temperature / 300 %}
    {[share, param_least]|max}, 0, {1 - share}
[gcode_macro GLOW]
gcode:
    SET_LED_TEMPLATE LED=toolhead TEMPLATE=glow PARAM_LEAST=0.5
"""


EFFECTS = """
[led_effect busy]
autostart: true
frame_rate: 24
leds:
    neopixel:toolhead (1,3)
layers:
    breathing  3 1 top (1,0,0)
[led_effect heating]
leds:
    neopixel:toolhead
heater: extruder
layers:
    # a comment
    stepper 1 1 top (1,0,0)
    temperature 20 80 add (0,0,1), (1,0,0)
[led_effect homing]
leds:
    neopixel:toolhead
layers:
    homing 1 1 top (1,0,0)
"""


def test_effects_of_the_plug_in_become_light_effects(tmp_path: Path):
    path = tmp_path / "printer.cfg"
    path.write_text(BASE + LIGHTS + EFFECTS, encoding="utf-8")
    draft = imported(path)
    settle(draft)
    effects = config.load_text(draft.text("")).light_effects
    assert list(effects) == ["busy", "heating"]
    busy, heating = effects.values()
    assert (busy.light, busy.leds, busy.kind, busy.period_s) == ("toolhead", [1, 3], "breathing", 3)
    assert busy.starts
    assert busy.colors == [[1.0, 0.0, 0.0]]
    assert (heating.kind, heating.low_c, heating.high_c) == ("heater", 20, 80)
    assert heating.heater == "hotend"
    assert any("effect that Passo has" in text for text in remarks(draft, "decide"))
    assert any("of temperature alone" in text for text in remarks(draft, "changed"))


def test_lights_become_lights(tmp_path: Path):
    path = tmp_path / "printer.cfg"
    path.write_text(BASE + LIGHTS, encoding="utf-8")
    draft = imported(path)
    settle(draft)
    machine = config.load_text(draft.text(""))
    assert list(machine.lights) == ["toolhead", "mixed", "chamber", "bar", "old"]
    head = machine.lights["toolhead"].model_dump()
    assert (head["order"], head["count"], head["start"]) == ("GRBW", 3, [0.1, 0.0, 0.0, 0.5])
    assert machine.lights["chamber"].model_dump()["pwm_hz"] == pytest.approx(200)
    assert machine.lights["mixed"].model_dump()["orders"] == ["GRB", "RGBW"]
    assert machine.lights["old"].model_dump()["kind"] == "pca9533"
    settings = Sections(machine).settings
    assert settings["neopixel toolhead"]["chain_count"] == 3
    assert settings["neopixel toolhead"]["initial_white"] == 0.5
    assert settings["neopixel mixed"]["color_order"] == "GRB, RGBW"


def test_templates_of_lights_come_along_where_lights_follow_them(tmp_path: Path):
    path = tmp_path / "printer.cfg"
    path.write_text(BASE + LIGHTS + TEMPLATES, encoding="utf-8")
    draft = imported(path)
    settle(draft)
    (glow,) = config.load_text(draft.text("")).light_templates.values()
    assert glow.variables == {"param_least": 0.25, "param_name": "nozzle"}
    assert glow.color.split("\n")[-1].strip() == "{[share, param_least]|max}, 0, {1 - share}"
    path.write_text(BASE + LIGHTS + TEMPLATES.partition("[gcode_macro")[0], encoding="utf-8")
    assert any("display_template glow" in text for text in remarks(imported(path), "dropped"))
