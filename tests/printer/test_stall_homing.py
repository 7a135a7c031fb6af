"""Axes that home by the stall detection of their drivers, on simulated motors that stall."""

import re

import pytest
from tests.support.scenario import Scenario
from tests.support.stall_machine import (
    belts_machine,
    homing,
    silent_machine,
    silent_text,
    spi_machine,
    with_table,
)

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError
from passo.job.batch.simulated_print import Print

SGTHRS, TCOOLTHRS, GCONF, COOLCONF, CURRENT = 0x40, 0x14, 0x00, 0x6D, 0x10


def irun(s, motor="x"):
    return s.board.drivers[motor].read(CURRENT) >> 8 & 31


def homed(s):
    return [line for line in s.host.ok("G28 X", 60) if "busy" not in line]


@pytest.mark.parametrize(
    ("chip", "firmware"), [("TMC2209", "virtual"), ("TMC2209", "passo"), ("TMC2226", "virtual")]
)
def test_axis_homes_by_a_stall_and_rests_off_the_stop(chip, firmware):
    text = silent_text(more=", current_a = 0.5", firmware=firmware).replace("TMC2209", chip)
    with Scenario(config.load_text(text, "stall.toml")) as s:
        assert homed(s) == ["ok"]
        assert s.positions()["x"] == pytest.approx(3.0, abs=0.02)
        assert "X:3.000" in s.host.ok("M114")[0]
        s.host.ok("G1 X150 F6000")
        assert homed(s) == ["ok"]
        assert s.positions()["x"] == pytest.approx(3.0, abs=0.02)


def test_driver_has_its_settings_again_after_homing():
    with Scenario(silent_machine(more=", current_a = 0.5")) as s:
        chip = s.board.drivers["x"]
        before = [chip.read(number) for number in range(128)]
        s.host.send("G28 X")
        assert s.until(lambda: chip.read(TCOOLTHRS) > 0, 5)
        # 12 MHz / (0.8 · 20 mm/s · 80 · 16), and 0.5 A in place of 0.8 A
        assert (chip.read(TCOOLTHRS), irun(s), chip.read(GCONF) >> 2 & 1) == (586, 15, 0)
        s.host.expect("^ok", 60)
        changed = {n for n in range(128) if chip.read(n) != before[n]}
        assert changed <= {0x02, 0x41}  # the counter of writes, the load


@pytest.mark.parametrize("way", ["M108", "M410"])
def test_stopped_homing_restores_the_driver(way):
    with Scenario(silent_machine(more=", current_a = 0.5")) as s:
        s.host.ok("G28 X", 60)
        s.host.ok("G1 X200 F6000")
        s.host.send("G28 X")
        s.passes(6)
        assert irun(s) == 15
        s.host.send(way)
        s.passes(2)
        assert irun(s) == 25
        assert s.board.drivers["x"].read(TCOOLTHRS) == 0
        assert 0 in s.printer.rig.job.locked_axes


def test_axis_at_its_stop_moves_away_and_homes_once_more():
    with Scenario(silent_machine()) as s:
        s.board.place("x", 0.2)
        assert homed(s) == ["ok"]
        assert s.positions()["x"] == pytest.approx(3.0, abs=0.02)


def test_sensitive_driver_is_refused_with_what_to_change():
    with Scenario(silent_machine(threshold=200)) as s:
        told = homed(s)[0]
        assert told.startswith("echo:axis X was not homed: the driver x at X_MIN detected a stall")
        assert "SGTHRS lower" in told and "0.39 mm" in told
        assert 0 in s.printer.rig.job.locked_axes
        assert s.board.drivers["x"].read(TCOOLTHRS) == 0


def test_driver_without_a_stall_is_refused_after_the_range():
    with Scenario(silent_machine(threshold=0)) as s:
        told = homed(s)[0]
        assert "detected no stall within 300 mm" in told and "SGTHRS higher" in told
        assert s.positions()["x"] == pytest.approx(0.0, abs=0.02)


def test_stall_that_stays_shown_names_pin_and_wire():
    with Scenario(spi_machine("TMC5160", "diag1_pin", 0)) as s:
        s.board.stalls["x"].stuck = True
        assert "the driver x at ^!X_MIN shows a stall while its motor is at rest" in homed(s)[0]


@pytest.mark.parametrize("chip", ["TMC2130", "TMC2240", "TMC5160"])
@pytest.mark.parametrize("key", ["diag0_pin", "diag1_pin"])
def test_drivers_on_spi_home_in_spreadcycle(chip, key):
    with Scenario(spi_machine(chip, key, 3)) as s:
        driver = s.board.drivers["x"]
        s.host.send("G28 X")
        assert s.until(lambda: driver.read(TCOOLTHRS) > 0, 5)
        assert driver.read(COOLCONF) >> 16 & 127 == 3
        assert driver.read(GCONF) >> (7 if key == "diag0_pin" else 8) & 1 == 1
        s.host.expect("^ok", 60)
        assert s.positions()["x"] == pytest.approx(3.0, abs=0.02)
        assert driver.read(GCONF) & 0x180 == 0


@pytest.mark.parametrize("home", ["x", "y"])
def test_either_motor_of_crossed_belts_stops_both(home):
    with Scenario(belts_machine()) as s:
        s.host.ok("G28 X Y", 120)
        assert s.positions()["a"] == pytest.approx(6.0, abs=0.05)
        assert s.positions()["b"] == pytest.approx(0.0, abs=0.05)
        s.host.ok("G1 X100 Y120 F6000")
        s.host.ok("M400", 10)
        other = "b" if home == "x" else "a"
        own = "a" if home == "x" else "b"
        s.board.stalls[own].friction = -1.0  # its load value never falls below the threshold
        s.host.ok(f"G28 {home.upper()}", 60)
        assert s.board.stalls[other].stalls > 0
        a, b = s.positions()["a"], s.positions()["b"]
        x, y = (a + b) / 2, (a - b) / 2
        assert (x if home == "x" else y) == pytest.approx(3.0, abs=0.05)
        assert (y if home == "x" else x) == pytest.approx(120 if home == "x" else 100, abs=0.05)


def test_print_without_consoles_rests_where_a_printer_does(tmp_path):
    path = tmp_path / "a.g"
    path.write_text("G28\nG91\nG1 X1 F600\n")
    printed = Print(silent_machine()).run(path)
    assert printed.final_position_mm["x"] == 4.0


@pytest.mark.parametrize("make", [silent_machine, lambda: spi_machine("TMC2130", "diag1_pin", 0)])
def test_calibration_finds_a_threshold_that_homes_exactly(make):
    with Scenario(make()) as s:
        s.board.place("x", 100.0)
        *_, told, _ok = s.host.ok("STALL_CALIBRATE AXIS=X REPEATS=3", 600)
        found = re.fullmatch(
            r"X: threshold (-?\d+) in place of (\d+); 3 times it stopped within (0\.\d+) mm\."
            " Save it with M500 or SAVE_CONFIG",
            told,
        )
        assert found and float(found[3]) < 0.05
        assert f"M914 X{found[1]}" in s.host.ok("M503")
        assert s.positions()["x"] == pytest.approx(3.0, abs=0.05)


def test_calibration_without_a_signal_keeps_the_threshold():
    with Scenario(silent_machine(threshold=60)) as s:
        s.board.place("x", 100.0)
        s.board.stalls["x"].friction = 0.45  # as much as the motor can do
        told = s.host.ok("STALL_CALIBRATE AXIS=X", 3000)
        assert "the stall detection of axis X is not reliable" in told[-2]
        assert "Home faster" in told[-2]
        assert s.host.ok("M914")[0] == "X homing sensitivity: 60"


def test_stored_threshold_counts_at_the_next_start(tmp_path):
    with Scenario(silent_machine(), state=str(tmp_path)) as s:
        s.host.ok("M914 X90")
        s.host.ok("M500")
    with Scenario(silent_machine(), state=str(tmp_path)) as s:
        assert s.host.ok("M914")[0] == "X homing sensitivity: 90"
        s.host.ok("M502")
        assert s.host.ok("M914")[0] == "X homing sensitivity: 60"


def test_thresholds_are_set_reported_and_refused():
    with Scenario(silent_machine()) as s:
        assert s.host.ok("M914 X90") == ["ok"]
        s.passes(0.5)
        assert s.board.drivers["x"].read(SGTHRS) == 90
        assert s.host.ok("M915 X S80") == ["ok"]
        assert s.host.ok("M914")[0] == "X homing sensitivity: 80"
        assert "M914 is Y: expected an axis that homes by a stall: X" in s.host.ok("M914 Y3")[0]
        assert "X is -3: expected a whole number, 0 to 255" in s.host.ok("M914 X-3")[0]
        assert "R is 2: expected 0 to 0" in s.host.ok("M915 X S80 R2")[0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            ("threshold = 60", "threshold = -3"),
            "threshold is -3: expected 0 to 255 for the TMC2209",
        ),
        (("threshold = 60", "threshold = 60, current_a = 5"), "current_a is 5.0: expected"),
        ((', diag_pin = "X_MIN"', ""), "homing.x.stall is missing: expected the pin diag_pin"),
        (("diag_pin", "diag1_pin"), "diag1_pin is 'X_MIN': expected diag_pin for a TMC2209"),
        (("stall =", 'pin = "Z_MAX"\nstall ='), "expected either pin, or stepper_pins"),
    ],
)
def test_wrong_keys_of_stall_detection_are_explained(change, message):
    text = silent_text()
    assert change[0] in text
    with pytest.raises(ConfigError) as error:
        config.load_text(text.replace(*change), "stall.toml")
    assert message in str(error.value)


def test_klippers_words_for_current_and_threshold_apply_to_homing():
    with Scenario(silent_machine()) as s:
        s.host.ok("SET_TMC_CURRENT STEPPER=stepper_x CURRENT=0.5")
        s.host.send("G28 X")
        assert s.until(lambda: s.board.drivers["x"].read(TCOOLTHRS) > 0, 5)
        assert irun(s) == 15
        s.host.expect("^ok", 60)
        assert irun(s) == 15
        s.host.ok("SET_TMC_CURRENT STEPPER=stepper_x CURRENT=0.8")
        s.host.ok("SET_TMC_FIELD STEPPER=stepper_x FIELD=SGTHRS VALUE=200")
        assert "detected a stall after" in homed(s)[0]
        assert s.host.ok("M914")[0] == "X homing sensitivity: 200"


def test_motors_of_crossed_belts_have_klippers_names():
    with Scenario(belts_machine()) as s:
        s.host.ok("SET_TMC_CURRENT STEPPER=stepper_x CURRENT=0.5")
        s.host.ok("SET_TMC_CURRENT STEPPER=stepper_b CURRENT=0.6")
        s.passes(1)
        assert (irun(s, "a"), irun(s, "b")) == (15, 19)


def test_towers_home_by_stalls_all_or_none():
    table = homing(60, home="a").replace('"min"', '"max"').replace("0.0", "318.0", 1)
    text = with_table(shipped_text("delta"), "homing.a", table)
    driver = 'driver = "TMC2209"\ntmc = { run_current_a = 0.8, uart_pin = "PD7", diag_pin = "PA7" }'
    text = text.replace("[steppers.a]", f"[steppers.a]\n{driver}")
    with pytest.raises(ConfigError, match="a stall detection of all arms or of none"):
        config.load_text(text, "delta.toml")


def test_belts_need_their_stall_detection_on_one_board():
    text = shipped_text("corexy")
    for motor, board in (("a", ""), ("b", "tool:")):
        pins = f'uart_pin = "{board}D40", diag_pin = "{board}X_MIN"'
        text = text.replace(
            f"[steppers.{motor}]", f"[steppers.{motor}]\ntmc = {{ run_current_a = 0.8, {pins} }}"
        )
    text = text.replace('socket = "Y"', 'socket = "tool:Y"')
    text = with_table(text, "homing.x", homing(60)) + '\n[boards.tool]\nbase = "ramps"\n'
    with pytest.raises(ConfigError, match="motors with stall detection on one board"):
        config.load_text(text, "belts.toml")
