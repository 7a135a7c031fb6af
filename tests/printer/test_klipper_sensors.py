"""Sensors of a board with Klipper's firmware, as a printer.cfg describes them: chips on its I2C
bus, and the sensor of its microcontroller."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.config.test_import_klipper import BASE
from tests.support.klipper_board import dictionary
from tests.support.klipper_printer import Board, Port, connected
from tests.support.scenario import Scenario

from passo import config
from passo.config.exporting.settings import Sections
from passo.config.importing.formats import imported
from passo.config.importing.settling import settle
from passo.printer.klipper.objects import objects
from passo.simulator.sensor_chips import SensorChip, sensor_chip

CHIPS = """
[temperature_sensor chamber]
sensor_type: BME280
i2c_address: 119
i2c_bus: i2c1_PB6_PB7
gcode_id: C
min_temp: 0
max_temp: 100
[temperature_sensor box]
sensor_type: SHT21
i2c_software_scl_pin: PC10
i2c_software_sda_pin: PC11
htu21d_report_time: 5
[temperature_sensor board]
sensor_type: temperature_mcu
"""
ADDRESSES = {"bme280": 119, "sht21": 64}
CHIP_C = 40.0
CHIP_V = 1.43 - 0.0043 * (CHIP_C - 25)  # of an STM32F103: its data sheet, 5.3.21


@pytest.fixture(params=["newer", "older"])
def board(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Board:
    it = Board(dictionary(chip="stm32", newer=request.param == "newer"), axes="")
    it.analog = round(CHIP_V / 3.3 * it.told["config"]["ADC_MAX"])
    it.i2c = {address: sensor_chip(kind, it.hz) for kind, address in ADDRESSES.items()}
    monkeypatch.setattr("tests.oracles.klipper_mcu._MOVES", 1024)
    monkeypatch.setattr("passo.printer.printer.connect", connected(Port(it)))
    return it


@pytest.fixture
def s(board: Board, tmp_path: Path) -> Iterator[Scenario]:
    path = tmp_path / "printer.cfg"
    path.write_text(BASE + CHIPS, encoding="utf-8")
    draft = imported(path)
    settle(draft)
    with Scenario(config.load_text(draft.text("From a test."), "printer.toml")) as scenario:
        yield scenario
    assert (board.wrong, board.late) == ([], [])


def shown(s: Scenario):
    return objects(s.machine, Sections(s.machine), s.printer.status.read(), {})


def test_chips_of_a_printer_cfg_reach_the_status(s: Scenario, board: Board) -> None:
    chip: SensorChip = board.i2c[119]
    chip.celsius, chip.humidity, chip.pressure_hpa = 38.5, 31.0, 1004.0
    s.passes(4)
    found = shown(s)
    assert found["bme280 chamber"]() == {
        "temperature": pytest.approx(38.5, abs=0.02),
        "humidity": pytest.approx(31, abs=0.05),
        "pressure": pytest.approx(1004, abs=0.05),
    }
    assert found["htu21d box"]().keys() == {"temperature", "humidity"}
    assert found["temperature_sensor chamber"]()["temperature"] == pytest.approx(38.5, abs=0.02)
    assert "temperature_sensor chamber" in found["heaters"]()["available_sensors"]
    assert " C:38.5" in s.host.ok("M105")[0]


def test_temperature_of_the_microcontroller_is_shown(s: Scenario) -> None:
    s.passes(2)
    assert shown(s)["temperature_sensor board"]()["temperature"] == pytest.approx(CHIP_C, abs=0.2)


def test_silent_chip_stops_the_board_of_older_firmware_alone(s: Scenario, board: Board) -> None:
    s.passes(4)
    board.i2c[119].plugged = False
    if board.told["enumerations"].get("i2c_bus_status"):
        s.host.expect("sensor chamber does not answer at address 119 on I2C .i2c1_PB6_PB7.", 8)
        s.passes(5)
        assert not s.printer.state.halted
        return
    s.host.expect("Printer halted: .*I2C NACK. A device on I2C, such as an accelerometer", 8)
