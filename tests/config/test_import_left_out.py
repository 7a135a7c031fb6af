"""An import always ends in a valid machine file: what Passo cannot take is left out, or has the
nearest value, and the report says so."""

from pathlib import Path

import pytest
from tests.config.test_import_klipper import BASE
from tests.support.import_remarks import remarks
from tests.support.scenario import Scenario

from passo import config
from passo.cli.main import main
from passo.config.importing.draft import Draft, Place
from passo.config.importing.formats import imported
from passo.config.importing.settling import settle
from passo.errors import ConfigError
from passo.job.mesh_folder import MeshFolder
from passo.job.settings_store import Store

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
        ("heater_pin: PA1", "heater_pin: multi_pin:both", "a [multi_pin] of this file"),
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
def test_only_the_wrong_part_is_left_out(load, more: str, reason: str) -> None:
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


def test_import_continues_without_missing_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("printer.cfg").write_text(f"[include a.cfg]\n[include sub/mainsail.cfg]\n{BASE}")
    assert main(["import", "printer.cfg", "--output", "mine.toml"]) == 0
    decide, changed = capsys.readouterr().out.split("Changed:")
    assert "printer.cfg:1: [include a.cfg]: the file is missing" in decide
    text = "printer.cfg:2: [include sub/mainsail.cfg]: PAUSE, RESUME and CANCEL_PRINT are always"
    assert text in changed
    assert main(["check", "mine.toml"]) == 0
    capsys.readouterr()


def test_missing_files_are_named_if_the_machine_cannot_move(tmp_path: Path) -> None:
    path = tmp_path / "printer.cfg"
    path.write_text("[include printer_part.cfg]\n[include mainsail.cfg]\n[extruder]\n")
    with pytest.raises(ConfigError) as caught:
        imported(path)
    codes = [(problem.code, problem.values["value"]) for problem in caught.value.problems]
    assert codes == [("import.section", "printer"), ("import.missing", "printer_part.cfg")]


def test_board_option_overrides_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("printer.cfg").write_text(BASE)
    assert main(["import", "printer.cfg", "--output", "mine.toml", "--board", "octopus"]) == 0
    assert config.load("mine.toml").board.base == "octopus"
    assert main(["import", "printer.cfg", "--output", "other.toml", "--board", "octopod"]) == 3
    assert "there is no board 'octopod'. Did you mean 'octopus'?" in capsys.readouterr().err


def test_retraction_fade_and_idle_times_are_taken_over(load) -> None:
    more = "[firmware_retraction]\nretract_length: 0.8\nretract_speed: 40\n[probe]\npin: PC14\n"
    more += "[bed_mesh]\nmesh_min: 10, 10\nmesh_max: 200, 200\nfade_end: 10\nadaptive_margin: 8\n"
    more += "faulty_region_1_min: 50, 60\nfaulty_region_1_max: 70, 80\n"
    more += "zero_reference_position: 110, 120\n[idle_timeout]\ntimeout: 900\ngcode: M117 idle\n"
    draft, machine = load(("max_temp: 250", "max_temp: 250\nmin_extrude_temp: 150"), more=more)
    assert remarks(draft, "decide") == []
    retraction = machine.retraction
    assert (retraction.length_mm, retraction.speed_mm_s, retraction.return_mm_s) == (0.8, 40, 10)
    assert (machine.idle.motors_off_s, machine.idle.heaters_off_s) == (900, 900)
    idle = machine.delayed_gcode["idle_timeout"]
    assert (idle.gcode, idle.when_idle) == ("M117 idle", True)
    levelling = machine.levelling
    assert (levelling.margin_mm, levelling.reference, levelling.fade_mm) == (8, [110, 120], 10)
    assert levelling.avoid == [[50, 60, 70, 80]]
    assert machine.limits.min_extrude_c == 150


STORED = """[probe]
pin: PC14
#*# <---------------------- SAVE_CONFIG ---------------------->
#*# [bed_mesh default]
#*# version = 1
#*# points =
#*# \t  0.1, 0.2, 0.3
#*# \t  0.4, 0.5, 0.6
#*# min_x = 10.0
#*# max_x = 200.0
#*# min_y = 20.0
#*# max_y = 210.0
#*# [skew_correction my]
#*# xy_skew = 0.001
"""


def test_stored_meshes_and_skews_go_to_the_state_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("printer.cfg").write_text(BASE + STORED)
    assert main(["import", "printer.cfg", "--output", "mine.toml", "--state", "state"]) == 0
    shown = capsys.readouterr().out
    assert "BED_MESH_PROFILE LOAD=default uses it" in shown
    assert "state: stored mesh default, SKEW_PROFILE SET=my XY=0.001" in shown
    mesh = MeshFolder(tmp_path / "state/meshes").named("default").mesh
    assert (mesh.xs, mesh.ys) == ((10, 105, 200), (20, 210))
    assert mesh.heights == ((0.1, 0.2, 0.3), (0.4, 0.5, 0.6))
    machine = config.load("mine.toml")
    stored = Store(tmp_path / "state/settings.json", machine.uuid).load()
    assert [str(one.setting) for one in stored or []] == [
        "SKEW_PROFILE SET=my XY=0.001000000",
        "SKEW_PROFILE SET=my XZ=0.000000000",
        "SKEW_PROFILE SET=my YZ=0.000000000",
    ]


@pytest.mark.parametrize(
    "kind",
    ["hybrid_corexy", "hybrid_corexz"],
)
def test_hybrid_machines_keep_the_motor_of_one_axis(load, kind: str) -> None:
    change = ("kinematics: cartesian", f"kinematics: {kind}")
    if kind == "hybrid_corexz":
        draft, machine = load(change)  # no endstop of a motor of Z would stop the belt
        assert "motor a of a belt moves with it" in "\n".join(remarks(draft, "decide"))
        assert "z" not in machine.homing
    _, machine = load(change, ("endstop_pin: PD7\n", ""))
    assert (machine.geometry.kind, list(machine.steppers)[:2]) == (kind, ["a", "y"])
    other = "y" if kind.endswith("y") else "z"
    point = dict(zip("xyz", (30.0, 20.0, 5.0), strict=True))
    assert machine.geometry.inverse((30.0, 20.0, 5.0)) == (30 - point[other], 20, 5)
    with Scenario(config.on_simulated_boards(machine)) as s:
        assert s.host.ok("G28", 120)[-1] == "ok"
        home = machine.geometry.inverse(machine.home_point)
        for motor, mm in zip(("a", "y", "z"), home, strict=True):
            step_mm = 1 / machine.steppers[motor].steps_per_unit
            assert s.positions()[motor] == pytest.approx(mm, abs=2 * step_mm)
        assert s.host.ok(f"G1 {other.upper()}10 F600")[-1] == "ok"
        s.host.ok("M400", 120)
        x, away = machine.home_mm["x"], 10.0
        assert s.positions()["a"] == pytest.approx(x - away, abs=0.05)


def test_driver_on_a_spi_unit_gets_the_pins_of_the_unit(load) -> None:
    more = "[tmc5160 stepper_x]\ncs_pin: PC9\nspi_bus: spi2\nrun_current: 0.8\n"
    draft, machine = load(more=more)
    tmc = machine.steppers["x"].tmc
    assert tmc is not None
    assert (tmc.miso_pin, tmc.mosi_pin, tmc.clock_pin) == ("PB14", "PB15", "PB13")
    assert "its pins are PB14, PB15, PB13" in "\n".join(remarks(draft, "changed"))


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
spi_bus: spi9
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
        "tmc5160 stepper_x": {"cs_pin": "PC9", "spi_bus": "spi9", "run_current": "0.8"},
        "fan_generic both": {"pin": "multi_pin:both"},
        "idle_timeout": {"gcode": "PARK"},
        "virtual_sdcard": {"path": "~/gcodes", "on_error_gcode": "CANCEL"},
        **{name: machine.klipper[name] for name in ("extruder",)},
    }
    dropped = "\n".join(remarks(draft, "dropped"))
    assert "sx1509_duex:PIN_7 is a pin of sx1509_duex, which is not a board" in dropped
    assert "macros read its settings and no state" in dropped
