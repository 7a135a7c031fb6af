"""Axes that home by the stall detection of their drivers, on simulated motors that stall."""

import pytest
from tests.support.scenario import Scenario
from tests.support.stall_machine import silent_machine, spi_machine

SGTHRS, TCOOLTHRS, GCONF, COOLCONF, CURRENT = 0x40, 0x14, 0x00, 0x6D, 0x10


def irun(s, motor="x"):
    return s.board.drivers[motor].read(CURRENT) >> 8 & 31


def homed(s):
    return [line for line in s.host.ok("G28 X", 60) if "busy" not in line]


@pytest.mark.parametrize("firmware", ["virtual", "passo"])
def test_axis_homes_by_a_stall_and_rests_off_the_stop(firmware):
    with Scenario(silent_machine(more=", current_a = 0.5", firmware=firmware)) as s:
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
        # 12 MHz / (0.6 · 20 mm/s · 80 · 16), and 0.5 A in place of 0.8 A
        assert (chip.read(TCOOLTHRS), irun(s), chip.read(GCONF) >> 2 & 1) == (781, 15, 0)
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


@pytest.mark.parametrize("chip", ["TMC2130", "TMC5160"])
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
