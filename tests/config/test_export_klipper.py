"""A machine file becomes a printer.cfg, and comes back as the same machine."""

from math import sqrt
from pathlib import Path

import pytest
from tests.support.edited_machine import edited

from passo import config
from passo.cli.main import main
from passo.config.exporting.klipper import exported
from passo.config.importing.klipper import imported
from passo.errors import ConfigError

# One of each geometry; with probes, screws, several motors of Z, drivers on UARTs and SPI.
MACHINES = ("i3-probe", "i3-two-z", "voron-2-4", "voron-0", "prusa-mk3s", "ender3-v2", "kossel")


def back(machine: config.MachineConfig, folder: Path) -> config.MachineConfig:
    """The machine of the printer.cfg of a machine."""
    path = folder / "printer.cfg"
    path.write_text(exported(machine).text("From a test."), encoding="utf-8")
    return config.load_text(imported(path).text("From a test."), "printer.toml")


@pytest.mark.parametrize("name", MACHINES)
def test_exported_klipper_file_imports_equal(name: str, tmp_path: Path) -> None:
    machine = config.load(name)
    other = back(machine, tmp_path)
    assert other.geometry == machine.geometry
    for axis in "xy":
        own, its = machine.axes[axis], other.axes[axis]
        limits = (own.min_mm, own.max_mm, own.speed_mm_s, own.accel_mm_s2)
        assert (its.min_mm, its.max_mm, its.speed_mm_s, its.accel_mm_s2) == pytest.approx(limits)
    limits = machine.limits
    corner = sqrt(limits.junction_deviation_mm * machine.axes["x"].accel_mm_s2 / (sqrt(2) - 1))
    corner = limits.square_corner_mm_s if limits.junction == "square_corner" else corner
    assert other.limits.square_corner_mm_s == pytest.approx(corner, rel=1e-6)
    assert other.steppers.keys() == machine.steppers.keys()
    for key, motor in machine.steppers.items():
        its = other.steppers[key]
        assert its.steps_per_unit == pytest.approx(motor.steps_per_unit, rel=1e-6)
        assert its.invert == motor.invert
        step = machine.pin_of_stepper(key, motor.step_pin or f"{motor.socket}_STEP")
        assert other.pin(its.step_pin or "") == step
        if motor.tmc:
            assert its.tmc and its.driver == motor.driver
            assert its.tmc.run_current_a == motor.tmc.run_current_a
            assert its.tmc.address == motor.tmc.address
            assert its.tmc.stealthchop_below_mm_s == motor.tmc.stealthchop_below_mm_s
    for key, homing in machine.homing.items():
        its = other.homing[key]
        assert (its.direction, its.probe) == (homing.direction, homing.probe)
        assert its.position == pytest.approx(homing.position, abs=1e-5)
        assert (its.pin and other.pin(its.pin)) == (homing.pin and machine.pin(homing.pin))
    for key, heater in machine.heaters.items():
        its = other.heaters[key]
        assert (its.min_c, its.max_c, its.max_power) == (
            heater.min_c,
            heater.max_c,
            heater.max_power,
        )
        assert its.pwm_hz == pytest.approx(heater.pwm_hz, rel=1e-6)
        assert (other.pin(its.pin), other.pin(its.sensor_pin)) == (
            machine.pin(heater.pin),
            machine.pin(heater.sensor_pin),
        )
        assert its.sensor.r25_ohm == pytest.approx(heater.sensor.r25_ohm, rel=1e-4)
        assert its.sensor.beta_k == pytest.approx(heater.sensor.beta_k, rel=1e-3)
    for key, fan in machine.fans.items():
        its = other.fans[key]
        assert (its.follows_motors, its.above_c) == (fan.follows_motors, fan.above_c)
        assert other.pin(its.pin) == machine.pin(fan.pin)
        assert its.pwm_hz == pytest.approx(fan.pwm_hz, rel=1e-6)
    assert other.levelling.motors == machine.levelling.motors
    if machine.probe:
        assert other.probe
        assert other.probe.offset_mm == machine.probe.offset_mm
        assert other.probe.trigger_height_mm == machine.probe.trigger_height_mm


def test_gains_shapers_advance_and_macros_come_back(tmp_path: Path) -> None:
    text = config.shipped_text("ender3-v2").replace(
        "accel_mm_s2 = 1000.0", "accel_mm_s2 = 1000.0\nadvance_s = 0.05", 1
    )
    text += '[shaping.x]\ntype = "ei"\nfrequency_hz = 41.0\ndamping = 0.12\n'
    text += '[macros.HELLO]\ngcode = """\n{% if true %}\nM117 hi\n{% endif %}\n"""\n'
    text += "variables = { count = 3, name = 'a b' }\n"
    text += 'literals = { stage = "None", tools = "{0: (1, 2)}" }\n'
    other = back(config.load_text(text, "mine.toml"), tmp_path)
    assert other.heaters["hotend"].control.kp == 28.72
    shaper = other.shaping["x"]
    assert (shaper.type, shaper.frequency_hz, shaper.damping) == ("ei", 41, 0.12)
    assert other.extruders["e"].advance_s == 0.05
    macro = other.macros["HELLO"]
    assert "M117 hi" in macro.gcode
    assert macro.variables == {"count": 3, "name": "a b"}
    assert macro.values() == macro.variables | {"stage": None, "tools": {0: (1, 2)}}


@pytest.mark.parametrize(
    "bus",
    [
        'cs_pin = "D40"\nclock_pin = "D42"\nmosi_pin = "D59"\nmiso_pin = "D64"\n',
        'spi_bus = "rpi:spidev0.0"\n[boards.rpi]\nbase = "klipper"\nclock_hz = 50000000\n'
        'link = "serial"\nport = "/tmp/rpi"\n',
        'chip = "lis2dw"\ni2c_bus = "rpi:i2c.1"\ni2c_address = 0x18\n[boards.rpi]\n'
        'base = "klipper"\nclock_hz = 50000000\nlink = "serial"\nport = "/tmp/rpi"\n',
        'chip = "lis2dw"\nscl_pin = "D40"\nsda_pin = "D42"\n',
    ],
)
def test_an_accelerometer_comes_back(bus: str, tmp_path: Path) -> None:
    board = ('base = "ramps"', 'base = "ramps"\nlink = "serial"\nport = "/dev/ttyUSB0"')
    board = board if "rpi" in bus else ('base = "ramps"', 'base = "ramps"')
    rate = "" if "lis2dw" in bus else "rate_hz = 1600\n"
    more = f'[accelerometer]\naxes_map = ["x", "-z", "y"]\naccel_per_hz = 75.0\n{rate}{bus}'
    machine = edited("i3", board, more=more)
    sections = exported(machine).sections
    chip = machine.accelerometer.chip
    assert sections[chip]["axes_map"] == "x, -z, y"
    assert sections["resonance_tester"] == {
        "accel_chip": chip,
        "probe_points": "125, 110, 20",
        "accel_per_hz": "75",
    }
    if "rpi" in bus:
        its = back(machine, tmp_path).accelerometer
        assert its is not None and its.point_mm == [125, 110, 20]
        own = machine.accelerometer.model_copy(update={"point_mm": its.point_mm})
        assert its == own
    elif chip == "lis2dw":  # the board is known to run Passo's firmware, and is an AVR
        assert sections["lis2dw"] == {
            "i2c_address": "25",
            "i2c_software_scl_pin": "PG1",
            "i2c_software_sda_pin": "PL7",
            "i2c_speed": "400000",
            "axes_map": "x, -z, y",
        }
    else:
        assert sections["adxl345"]["spi_software_sclk_pin"] == "PL7"


def test_sensors_come_before_heaters_and_losses_are_named() -> None:
    cfg = exported(config.load("radds"))
    text = cfg.text("")
    assert text.index("[thermistor ") < text.index("heater_pin")
    assert "Klipper has no such axis" in " ".join(cfg.left_out)
    assert any("PID_CALIBRATE" in sentence for sentence in cfg.left_out)
    assert "[heater_bed]" in text and "control: watermark" in text


def test_other_geometries_are_refused() -> None:
    with pytest.raises(ConfigError, match="Passo exports cartesian, corexy, corexz, hybrid"):
        exported(config.load("scara"))


def test_command_writes_a_file_once(tmp_path: Path, capsys) -> None:
    output = tmp_path / "printer.cfg"
    words = ["export", "--klipper", "voron-0", "--output", str(output)]
    assert main(words) == 0
    assert "kinematics: corexy" in output.read_text(encoding="utf-8")
    assert "PID_CALIBRATE" in capsys.readouterr().out
    assert main(words) == 4
    assert main([*words[:-1], str(tmp_path / "none" / "printer.cfg")]) == 4


def test_comments_of_macros_come_back(tmp_path: Path) -> None:
    gcode = "{# one { 1 / 0 } #}\nM118 a {#- two #}\nM118 b{# gone #} c\n{# three\nfour #}"
    machine = edited("i3", more=f"[macros.HELLO]\ngcode = '''\n{gcode}\n'''\n")
    assert "\n  # one { 1 / 0 }\n  M118 a # two\n" in exported(machine).text("From a test.")
    assert back(machine, tmp_path).macros["HELLO"].gcode.splitlines() == [
        *gcode.replace("{# gone #}", "").splitlines()[:3],
        "{# three #}",
        "{# four #}",
    ]
