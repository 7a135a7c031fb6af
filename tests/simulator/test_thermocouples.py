"""Converters that the board asks by itself, and the range that it watches."""

from __future__ import annotations

import pytest
from tests.support.raw_board import RawBoard

from passo import _core

REST = 4000
OPEN = 0x10001
REGISTERS = ("MAX31856", "MAX31865")


def share(celsius: float) -> float:
    return (4 * celsius + 8192) / 16384


def wired(kind: str = "MAX31855") -> RawBoard:
    """oid 1 the converter on the SPI device 0, over pins that the bench has; the bench's hotend."""
    board = RawBoard()
    mode = int(kind in REGISTERS)
    pins = board.dictionary.enumerations["pin"]
    _core.add_converter(
        board.device, pins["PK5"], pins["PH6"], pins["PH5"], pins["PE5"],
        getattr(_core.Converter, kind),
    )  # fmt: skip
    for line in (
        "allocate_oids count=2",
        "config_spi oid=0 pin=PK5 cs_active_high=0",
        f"spi_set_sw_bus oid=0 miso_pin=PE5 mosi_pin=PH5 sclk_pin=PH6 mode={mode} pulse_ticks=16",
        f"config_thermocouple oid=1 spi_oid=0 thermocouple_type={kind}",
        "finalize_config crc=1",
    ):
        assert board.tell(line) == []
        assert board.device.fault == "", line
    return board


def ask(board: RawBoard, minimum: int = 0, maximum: int = 2**32 - 1, count: int = 4) -> None:
    board.tell(
        f"query_thermocouple oid=1 clock={board.clock(1000)} rest_ticks={REST}"
        f" min_value={minimum} max_value={maximum} max_invalid_count={count}"
    )


def words(reports: list) -> list[int]:
    return [v["value"] for name, v in reports if name == "thermocouple_result"]


@pytest.mark.parametrize(("kind", "shift"), [("MAX31855", 18), ("MAX6675", 3)])
def test_converter_words_come_at_their_times(kind, shift):
    board = wired(kind)
    board.simulated.force_sensor("hotend", share(200))
    ask(board)
    first = board.clock(1000)
    assert board.wait(999) == []
    for k in range(3):
        [(name, values)] = board.wait(1 if k == 0 else REST)
        assert name == "thermocouple_result"
        assert values["value"] >> shift == 800
        assert values["next_clock"] == first + REST * (k + 1) & 0xFFFFFFFF
    board.tell(
        f"query_thermocouple oid=1 clock=0 rest_ticks=0 min_value=0 max_value={2**32 - 1}"
        " max_invalid_count=0"
    )
    assert board.wait(10 * REST) == []


@pytest.mark.parametrize("count", [0, 1, 4])
@pytest.mark.parametrize("ratio", [share(19), share(251)])
def test_a_range_that_is_left_shuts_the_board_down(count, ratio):
    board = wired()
    board.simulated.force_sensor("hotend", share(20))
    ask(board, 80 << 18, (1000 << 18) | 0x3FFFF, count)
    board.wait(1000 + 5 * REST)
    assert board.device.fault == ""
    board.simulated.force_sensor("hotend", ratio)
    for _ in range(count - 1):
        board.wait(REST)
        assert board.device.fault == ""
    board.wait(REST)
    assert board.device.fault == "Thermocouple ADC out of range"
    # It is still asked after that.
    assert len(words(board.wait(3 * REST))) == 3


def test_converter_faults_count_with_good_readings_between():
    board = wired()
    board.simulated.force_sensor("hotend", share(20))
    ask(board, 0, 2**31, 2)
    for ratio in (1.0, share(20), 1.0, share(20)):
        board.wait(REST)
        assert board.device.fault == ""
        board.simulated.force_sensor("hotend", ratio)
    board.simulated.force_sensor("hotend", 1.0)
    assert words(board.wait(REST)) == [OPEN]
    board.wait(REST)
    assert board.device.fault == "Thermocouple reader fault"


@pytest.mark.parametrize(
    ("kind", "setup", "word", "fault"),
    [("MAX31856", "8090", 300 << 12, 0x01), ("MAX31865", "80c2", 16384 << 1, 0x80)],
)
def test_converter_with_registers_is_asked_for_faults(kind, setup, word, fault):
    """It knows nothing before it has been told to measure; only a MAX31865 keeps its faults."""
    board = wired(kind)
    at = 0.5 if kind == "MAX31865" else (128 * 300 + 2**18) / 2**19
    board.simulated.force_sensor("hotend", at)
    ask(board, 0, 2**31, 2)

    def said() -> list[tuple[int, int]]:
        reports = board.wait(REST)
        return [(v["value"], v["fault"]) for name, v in reports if name == "thermocouple_result"]

    assert said() == [(0, 0)]
    board.tell(f"spi_send oid=0 data={setup}")
    assert said() == [(word, 0)]
    board.simulated.force_sensor("hotend", 1.0)
    [(_, found)] = said()
    assert found == fault
    board.simulated.force_sensor("hotend", at)
    if kind == "MAX31865":
        board.tell(f"spi_send oid=0 data={setup}")
    assert said() == [(word, 0)]
    for _ in range(2):
        board.simulated.force_sensor("hotend", 1.0)
        board.wait(REST)
    assert board.device.fault == "Thermocouple reader fault"


def test_full_word_range_disables_the_check():
    board = wired()
    board.simulated.force_sensor("hotend", 1.0)
    ask(board, count=1)
    assert words(board.wait(1000 + 3 * REST)) == [OPEN] * 4
    assert board.device.fault == ""


@pytest.mark.parametrize(
    ("lines", "fault"),
    [
        (["config_thermocouple oid=1 spi_oid=0 thermocouple_type=MAX6675"], "Invalid oid type"),
        (["query_thermocouple oid=1 clock=0 rest_ticks=0 min_value=0 max_value=0"
          " max_invalid_count=0"],
         "Invalid oid type"),
    ],
)  # fmt: skip
def test_misuse_shuts_the_board_down(lines, fault):
    board = RawBoard()
    board.tell("allocate_oids count=2")
    for line in lines:
        board.tell(line)
    assert board.device.fault == fault
