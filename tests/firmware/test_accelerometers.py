"""Accelerometers on an SPI bus: what the firmware refuses, and how it marks disturbed answers."""

from __future__ import annotations

import pytest
from tests.support.raw_board import RawBoard

from passo.resonance.measurement import decoded

PINS = {"select": "PB4", "miso": "PE5", "mosi": "PH5", "clock": "PH6"}
REST = 20_000


def wired(*, finished: bool = True) -> RawBoard:
    """A chip (oid 1) on an SPI device (oid 0), or the device alone if not `finished`."""
    board = RawBoard()
    chip = ["config_adxl345 oid=1 spi_oid=0", "finalize_config crc=1"] if finished else []
    for line in (
        "allocate_oids count=2",
        f"config_spi oid=0 pin={PINS['select']} cs_active_high=0",
        f"spi_set_sw_bus oid=0 miso_pin={PINS['miso']} mosi_pin={PINS['mosi']}"
        f" sclk_pin={PINS['clock']} mode=3 pulse_ticks=2",
        *chip,
    ):
        board.tell(line)
    return board


@pytest.mark.parametrize("high", [False, True])
def test_a_disturbed_answer_is_marked_and_its_place_kept(high: bool) -> None:
    """All bits low or high are no answer of an ADXL345, whose FIFO is set up."""
    board = wired()
    board.simulated.force_switch("x", high)
    assert board.tell(f"query_adxl345 oid=1 rest_ticks={REST}") == []
    [(name, values)] = board.wait(10 * REST + 100)
    assert (name, values["oid"], values["sequence"]) == ("sensor_bulk_data", 1, 0)
    assert values["data"] == b"\xff" * 50
    assert decoded("adxl345", values["data"], ((0, 1), (1, 1), (2, 1))) == [(0, 0, 0)] * 10
    states = board.tell("query_adxl345_status oid=1")
    assert [name for name, _ in states] == ([] if high else ["sensor_bulk_status"])
    board.tell("query_adxl345 oid=1 rest_ticks=0")
    assert board.wait(10 * REST) == []


def test_the_bus_may_come_after_the_chip_but_must_come() -> None:
    """Kalico tells the chip first."""
    board = RawBoard()
    for line in (
        "allocate_oids count=2",
        f"config_spi oid=0 pin={PINS['select']} cs_active_high=0",
        "config_adxl345 oid=1 spi_oid=0",
        "query_adxl345 oid=1 rest_ticks=0",
    ):
        board.tell(line)
    assert board.device.fault == ""
    board.tell("query_adxl345_status oid=1")
    assert board.device.fault == "SPI device without a bus"


@pytest.mark.parametrize(
    ("name", "values", "fault"),
    [
        ("config_lis2dw", [1, 0, 1, 0], "Invalid accelerometer type"),
        ("config_adxl345", [1, 1], "Invalid oid type"),
        ("query_lis2dw", [0, 1000], "Invalid oid type"),
        ("query_adxl345", [1, 1], "Period too short for this board"),
    ],
)
def test_misuse_shuts_the_board_down(name: str, values: list[int], fault: str) -> None:
    board = wired(finished=name.startswith("query"))
    board.feed(board.commands.encode(name, values))
    assert board.device.fault == fault
