"""An import always ends in a valid machine file: what Passo cannot take is left out, or has the
nearest value, and the report says so."""

from pathlib import Path

import pytest
from tests.config.test_import_klipper import BASE
from tests.support.import_remarks import remarks

from passo import config
from passo.cli.main import main
from passo.config.importing.draft import Draft, Place
from passo.config.importing.formats import imported
from passo.config.importing.settling import settle
from passo.errors import ConfigError

HOST = "[mcu rpi]\nserial: /tmp/klipper_host_mcu\n"


@pytest.fixture
def load(tmp_path: Path):
    """A function from BASE with changes to its draft and its machine."""

    def convert(*changes: tuple[str, str], more: str = ""):
        text = BASE
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "printer.cfg"
        path.write_text(text + more, encoding="utf-8")
        draft = imported(path)
        return draft, config.load_text(draft.text("From a test."), "printer.toml")

    return convert


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("max_temp: 250\n", "", "printer.cfg:43: [extruder]: the heater is left out: max_temp in"),
        ("sensor_pin: PC5\n", "", "sensor_pin in [extruder] is missing"),
        ("sensor_type: mine", "sensor_type: yours", "sensor_type in [extruder] is 'yours'"),
        ("max_temp: 250", "max_temp: hot", "max_temp in [extruder] is 'hot': expected a number"),
        ("heater_pin: PA1", "heater_pin: multi_pin:both", "does not switch several outputs"),
        ("resistance2: 1641.9", "resistance2: 100000", "points of one falling curve"),
        ("sensor_type: mine", "sensor_type: MAX6675\nspi_bus: spi9", "does not use the chip's SPI"),
    ],
)
def test_heater_without_a_sure_sensor_is_left_out(load, old: str, new: str, reason: str) -> None:
    draft, machine = load((old, new))
    assert "hotend" not in machine.heaters
    assert machine.extruders["e"]
    assert reason in "\n".join(remarks(draft, "decide"))
    assert "until heaters.hotend is decided" in "\n".join(remarks(draft, "decide"))
    assert machine.board.link == "simulated"


@pytest.mark.parametrize(
    ("more", "reason"),
    [
        (
            "[input_shaper]\nshaper_freq_x: 50\nshaper_type: best\n",
            "[input_shaper]: the section is",
        ),
        ("[gcode_macro BROKEN]\ngcode:\n  {% if %}\n", "macros.BROKEN: it is left out"),
        ("[delayed_gcode x]\ngcode:\n  {x|nothing}\n", "delayed_gcode.x: it is left out"),
        ("[heater_fan x]\npin: PC9\nheater: none\n", "[heater_fan x]: the section is left out"),
        ("[heater_fan x]\npin: PA8\n", "fans.x: it is left out: fans.x.pin is 'PA8'"),
        ("[probe]\npin: PC14\nsamples_result: best\n", "[probe]: the section is left out"),
        (
            "[tmc2209 stepper_x]\nuart_pin: PC9\nrun_current: 0.8\nuart_address: 7\n",
            "steppers.x.tmc: it is left out: steppers.x.tmc.address is 7",
        ),
    ],
)
def test_part_that_is_wrong_is_left_out_alone(load, more: str, reason: str) -> None:
    draft, machine = load(more=more)
    assert reason in "\n".join(remarks(draft, "decide"))
    assert (machine.board.link, [*machine.heaters]) == ("serial", ["hotend", "bed"])


def test_number_out_of_range_becomes_the_nearest(load) -> None:
    changes = ("min_temp: 0\nmax_temp: 250", "min_temp: -250\nmax_temp: 250"), ("130", "5000")
    draft, machine = load(*changes, ("kick_start_time: 0.3", "kick_start_time: 30"))
    assert machine.heaters["hotend"].min_c == -100
    assert 300 <= machine.heaters["bed"].max_c < 1200  # where the table of its sensor ends
    assert machine.fans["part"].kick_start_s == 10
    text = "\n".join(remarks(draft, "changed"))
    assert "heaters.hotend.min_c: -250 became -100: expected a number of at least -100" in text
    assert "fans.part.kick_start_s: 30 became 10" in text


def test_pulses_are_as_fast_as_the_board_can(load) -> None:
    fast = ("max_delta: 1.5", "max_delta: 1.5\npwm_cycle_time: 0.001")
    assert load(fast)[1].heaters["bed"].pwm_hz == 1000
    draft, machine = load(fast, ("STM32F103", "ATmega2560"))
    assert machine.heaters["bed"].pwm_hz == 250
    assert "heaters.bed.pwm_hz: 1000 became 250" in "\n".join(remarks(draft, "changed"))


def test_converter_on_a_unit_of_the_chip_has_its_pins(load) -> None:
    sensor = "sensor_type: MAX31865\nspi_bus: {}\nrtd_nominal_r: 1000\nrtd_reference_r: 4300\n"
    for bus in ("spi2", "spi2_PB14_PB15_PB13"):
        _, machine = load(("sensor_type: mine\n", sensor.format(bus)))
        found = machine.heaters["hotend"].sensor.model_dump()
        pins = [found[f"{name}_pin"] for name in ("miso", "mosi", "clock")]
        assert pins == ["PB14", "PB15", "PB13"]
        assert (found["r0_ohm"], found["reference_ohm"], found["wires"]) == (1000, 4300, 2)


def test_microsteps_of_other_drivers_are_full_steps(load) -> None:
    draft, machine = load(("enable_pin: !PC3\nmicrosteps: 16", "enable_pin: !PC3\nmicrosteps: 10"))
    motor = machine.steppers["x"]
    assert (motor.full_steps_per_rotation, motor.microsteps) == (2000, 1)
    assert "the steps of a rotation are 2000" in "\n".join(remarks(draft, "changed"))


def test_scale_that_is_wrong_is_refused_with_its_line(load) -> None:
    with pytest.raises(ConfigError) as caught:
        load(("rotation_distance: 34.4", "rotation_distance: -34.4"))
    assert "printer.cfg:48: steppers.e.rotation_distance_mm is -34.4" in str(caught.value)


def test_board_without_a_part_is_left_out(load) -> None:
    draft, machine = load(more=HOST)
    assert machine.boards == {}
    assert "no part of the machine file is on it" in "\n".join(remarks(draft, "dropped"))
    _, machine = load(more=f"{HOST}[adxl345]\ncs_pin: rpi:None\n")
    assert machine.boards["rpi"].clock_hz == 50_000_000
    assert machine.accelerometer is not None
    assert machine.accelerometer.spi_bus == "rpi:spidev0.0"


def test_every_draft_becomes_valid_or_names_a_place() -> None:
    """A key that the model does not have is left out; a machine without axes is refused."""
    draft = Draft()
    place = Place("printer.cfg", 7)
    draft.put(("name",), "a", place)
    draft.put(("colour",), "red", place)
    with pytest.raises(ConfigError) as caught:
        settle(draft)
    assert "printer.cfg:7: geometry is missing" in str(caught.value)
    assert ("colour",) not in draft.keys


def test_missing_includes_are_listed_together_or_skipped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("printer.cfg").write_text(f"[include a.cfg]\n[include sub/b.cfg]\n{BASE}")
    assert main(["import", "printer.cfg", "--output", "mine.toml"]) == 3
    shown = capsys.readouterr().err
    assert "printer.cfg:1: the included file 'a.cfg'" in shown
    assert "printer.cfg:2: the included file 'sub/b.cfg'" in shown
    skip = ["import", "printer.cfg", "--output", "mine.toml", "--missing-includes", "skip"]
    assert main(skip) == 0
    text = "printer.cfg:1, 2: [include a.cfg]; [include sub/b.cfg]: the file is missing"
    assert text in capsys.readouterr().out
    assert main(["check", "mine.toml"]) == 0
    capsys.readouterr()


def test_board_of_the_command_line_counts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("printer.cfg").write_text(BASE)
    assert main(["import", "printer.cfg", "--output", "mine.toml", "--board", "octopus"]) == 0
    assert config.load("mine.toml").board.base == "octopus"
    assert main(["import", "printer.cfg", "--output", "other.toml", "--board", "octopod"]) == 3
    assert "there is no board 'octopod'. Did you mean 'octopus'?" in capsys.readouterr().err


def test_settings_are_commands_of_the_report(load) -> None:
    more = "[firmware_retraction]\nretract_length: 0.8\nretract_speed: 40\n[probe]\npin: PC14\n"
    more += "[bed_mesh]\nmesh_min: 10, 10\nmesh_max: 200, 200\nfade_end: 10\nadaptive_margin: 8\n"
    more += "zero_reference_position: 110, 120\n[idle_timeout]\ntimeout: 900\ngcode: M117 idle\n"
    draft, machine = load(
        more=f"{more}#*# <---------------------- SAVE_CONFIG ----------------------"
        ">\n#*# [bed_mesh default]\n#*# version = 1\n#*# points =\n#*# \t  0.1, 0.2\n"
    )
    found = "\n".join(remarks(draft, "decide"))
    assert "M207 S0.8 F2400 and M208 S0 F600 set them" in found
    assert "fade_end: the fade is not in the machine file: M420 Z10 sets it" in found
    assert "[bed_mesh default]: the stored heights are not taken over" in found
    assert (machine.idle.motors_off_s, machine.idle.heaters_off_s) == (900, 900)
    levelling = machine.levelling
    assert (levelling.margin_mm, levelling.reference) == (8, [110, 120])


def test_constants_of_kalico_are_filled_in(load) -> None:
    constant = "[constants]\nhot: 245\nmost: ${constants.hot}\n"
    _, machine = load(("max_temp: 250", "max_temp: ${constants.most}"), more=constant)
    assert machine.heaters["hotend"].max_c == 245


def test_lines_of_save_config_count_only_after_its_head(load) -> None:
    _, machine = load(("min_temp: 0\nmax_temp: 250", "min_temp: 0\n#*# [HOT]\nmax_temp: 250"))
    assert machine.heaters["hotend"].max_c == 250


def test_step_distance_of_old_files_is_the_scale(load) -> None:
    old = "rotation_distance: 34.4", "step_distance: 0.01"
    _, machine = load(old)
    assert machine.steppers["e"].steps_per_mm == 100


def test_limits_of_each_axis_of_kalico(load) -> None:
    more = "kinematics: limited_cartesian\nmax_x_accel: 9000\nmax_y_velocity: 200"
    _, machine = load(("kinematics: cartesian", more))
    assert machine.geometry.kind == "cartesian"
    assert (machine.axes["x"].accel_mm_s2, machine.axes["y"].accel_mm_s2) == (9000, 3000)
    assert (machine.axes["x"].speed_mm_s, machine.axes["y"].speed_mm_s) == (300, 200)


def test_keys_of_variables_may_be_any_text(load) -> None:
    values = "{'calibrating z': {'r': 1.0}, 'a\"b': 2}"
    more = f"[gcode_macro SHOW]\nvariable_colours: {values}\ngcode:\n  M117\n"
    _, machine = load(more=more)
    assert machine.macros["SHOW"].variables["colours"] == {"calibrating z": {"r": 1.0}, 'a"b': 2}


def test_axis_without_the_place_of_its_endstop_does_not_home(load) -> None:
    draft, machine = load(("position_endstop: 0.5\n", ""))
    assert "z" not in machine.homing
    assert "position_endstop is not in the file: G28 does not move this axis" in "\n".join(
        remarks(draft, "decide")
    )


READERS = """
[gcode_macro READ]
gcode:
  {% if printer["output_pin lock"].value and printer.motors_sync.applied %}
  {% endif %}
  {% set current = printer.configfile.settings["tmc5160 stepper_x"].run_current %}
  SET_FAN_SPEED FAN=both SPEED=1
[output_pin lock]
pin: sx1509_duex:PIN_7
value: 1
[motors_sync]
axes: x,y
[tmc5160 stepper_x]
cs_pin: PC9
spi_bus: spi1
run_current: 0.8
[fan_generic both]
pin: multi_pin:both
[servo arm]
pin: PC9
[idle_timeout]
gcode: PARK
[virtual_sdcard]
path: ~/gcodes
on_error_gcode: CANCEL
"""


def test_parts_that_macros_name_are_kept_for_them(load) -> None:
    draft, machine = load(more=READERS)
    assert {name: dict(options) for name, options in machine.klipper.items()} == {
        "output_pin lock": {"pin": "sx1509_duex:PIN_7", "value": "1"},
        "motors_sync": {"axes": "x,y"},
        "tmc5160 stepper_x": {"cs_pin": "PC9", "spi_bus": "spi1", "run_current": "0.8"},
        "fan_generic both": {"pin": "multi_pin:both"},
        "idle_timeout": {"gcode": "PARK"},
        "virtual_sdcard": {"path": "~/gcodes", "on_error_gcode": "CANCEL"},
        **{name: machine.klipper[name] for name in ("extruder",)},
    }
    dropped = "\n".join(remarks(draft, "dropped"))
    assert "sx1509_duex:PIN_7 is a pin of sx1509_duex, which is not a board" in dropped
    assert "of motors_sync macros read its settings and no state" in dropped
