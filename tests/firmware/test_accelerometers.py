"""Accelerometers on SPI and I2C: what the firmware refuses, and how it marks disturbed answers."""

from __future__ import annotations

import pytest
from tests.support.raw_board import RawBoard

from passo import _core
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
        ("config_lis2dw", [1, 0, 2, 0], "Invalid accelerometer type"),
        ("config_lis2dw", [1, 0, 0, 1], "Invalid accelerometer type"),
        ("config_lis2dw", [1, 0, 1, 0], "Invalid oid type"),
        ("config_adxl345", [1, 1], "Invalid oid type"),
        ("query_lis2dw", [0, 1000], "Invalid oid type"),
        ("query_adxl345", [1, 1], "Period too short for this board"),
    ],
)
def test_misuse_shuts_the_board_down(name: str, values: list[int], fault: str) -> None:
    board = wired(finished=name.startswith("query"))
    board.feed(board.commands.encode(name, values))
    assert board.device.fault == fault


class Lis2dw:
    """The chip (oid 1) on SPI or I2C (oid 0); it takes a sample each 10 000 ticks, from the next
    call of `start` on."""

    def __init__(self, bus: str) -> None:
        self.board, self.bus = RawBoard(), bus
        number = self.board.dictionary.enumerations["pin"]
        select, miso, mosi, clock = (number[pin] for pin in PINS.values())
        kind, hz = _core.AccelerometerKind.LIS2DW, 16e6
        device = self.board.device
        if bus == "spi":
            self.chip = _core.add_accelerometer(device, select, clock, mosi, miso, kind, hz)
            lines = [
                f"config_spi oid=0 pin={PINS['select']} cs_active_high=0",
                f"spi_set_sw_bus oid=0 miso_pin={PINS['miso']} mosi_pin={PINS['mosi']}"
                f" sclk_pin={PINS['clock']} mode=3 pulse_ticks=2",
            ]
        else:
            self.chip = _core.add_i2c_accelerometer(device, clock, mosi, 0x19, kind, hz)
            lines = [
                "config_i2c oid=0",
                f"i2c_set_sw_bus oid=0 scl_pin={PINS['clock']} sda_pin={PINS['mosi']}"
                " pulse_ticks=20 address=25",
            ]
        for line in (
            "allocate_oids count=2",
            *lines,
            f"config_lis2dw oid=1 bus_oid=0 bus_oid_type={bus} lis_chip_type=LIS2DW",
            "finalize_config crc=1",
        ):
            assert self.board.tell(line) == []

    def start(self, rest: int) -> None:
        word = "spi_send oid=0 data=2094" if self.bus == "spi" else self._write("2094")
        self.board.tell(word)
        assert self.board.tell(f"query_lis2dw oid=1 rest_ticks={rest}") == []

    def measured(self, samples: int) -> list[tuple[float, float, float]]:
        """What the blocks hold that are reported while the chip takes so many samples; there is
        none between two blocks."""
        found = [
            values for name, values in self.board.wait(10_000 * samples) if name != "i2c_response"
        ]
        assert [values["sequence"] for values in found] == list(range(len(found)))
        data = b"".join(values["data"] for values in found)
        return decoded("lis2dw", data, ((0, 1), (1, 1), (2, 1)))

    def state(self) -> dict:
        [(_, values)] = self.board.tell("query_lis2dw_status oid=1")
        return values

    def _write(self, data: str) -> str:
        return f"i2c_transfer oid=0 write={data} read_len=0"


@pytest.mark.parametrize("rest", [40_000, 115_000, 250_000])
def test_the_same_samples_come_over_i2c_as_over_spi(rest: int) -> None:
    """Whether one transfer takes a part of a block, all of it, or many follow each other."""
    chips = [Lis2dw(bus) for bus in ("spi", "i2c")]
    for it in chips:
        it.start(rest)
    one, other = (it.measured(400) for it in chips)
    assert len(other) >= 400 - 8 - rest // 10_000
    count = min(len(one), len(other))
    assert abs(len(one) - len(other)) <= 8 and one[:count] == other[:count]
    state = chips[1].state()
    assert state["next_sequence"] * 8 + state["buffered"] // 6 == 400
    assert state["possible_overflows"] == 0


def test_a_chip_that_does_not_acknowledge_keeps_its_samples() -> None:
    """Its FIFO holds 32."""
    undisturbed, it = Lis2dw("i2c"), Lis2dw("i2c")
    for chip in (undisturbed, it):
        chip.start(40_000)
    wanted = undisturbed.measured(400)
    it.chip.nacks = 5  # at the states, 4 samples apart
    assert it.measured(20) == []
    found = [
        values["data"] for name, values in it.board.wait(3_800_000) if name == "sensor_bulk_data"
    ]
    assert decoded("lis2dw", b"".join(found), ((0, 1), (1, 1), (2, 1))) == wanted[: 8 * len(found)]
    assert len(found) >= 48 and it.state()["possible_overflows"] == 0
    it.chip.plugged = False
    assert it.board.tell("query_lis2dw_status oid=1") == []  # the host asks again
    assert it.board.wait(4_000_000) == []
    it.chip.plugged = True
    assert it.state()["possible_overflows"] == 1
    assert it.board.device.fault == ""


def test_an_i2c_bus_may_come_after_the_chip_but_must_come() -> None:
    board = RawBoard()
    for line in (
        "allocate_oids count=2",
        "config_i2c oid=0",
        "config_lis2dw oid=1 bus_oid=0 bus_oid_type=i2c lis_chip_type=LIS2DW",
        "query_lis2dw oid=1 rest_ticks=0",
    ):
        assert board.tell(line) == [] and board.device.fault == ""
    board.tell("query_lis2dw oid=1 rest_ticks=1000")
    assert board.device.fault == "I2C device without a bus"
