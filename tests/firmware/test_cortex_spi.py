"""What SPI devices hear, also when a board shuts down while the foreground is speaking to one."""

from __future__ import annotations

from typing import Any

import pytest

from .talk import Host
from .test_cortex import CASES, TAKEN, Case, board_target

LAST = "a55a"
TRANSFER = "0102030405"
SELECTS = ("first", "second")  # the devices, of which one is selected at a time


def bits(data: str) -> str:
    return "".join(f"{byte:08b}" for byte in bytes.fromhex(data))


def heard(host: Host, names: dict[str, str], mode: int = 0) -> list[tuple[str, str]]:
    """Who was selected, and the bits of the bus until that ended."""
    rest, second_phase = mode >> 1, mode & 1
    numbers = host.dictionary.enumerations["pin"]
    pins = {numbers[pin]: name for name, pin in names.items()}
    levels = {"mosi": 0, "first": 1, "second": 1}
    taken = dict.fromkeys(SELECTS, "")
    told: list[tuple[str, str]] = []
    for _, pin, level in host.chip.edges:
        name = pins.get(pin, "")
        if name == "clock" and level == (rest if second_phase else 1 - rest):
            for select in SELECTS:
                taken[select] += str(levels["mosi"]) if levels[select] == 0 else ""
        elif name in levels:
            levels[name] = level
            if name in SELECTS and level:
                told.append((name, taken[name]))
                taken[name] = ""
    return told


def wired(mode: int) -> tuple[Case, Host, dict[str, str]]:
    """Two devices on a bus with a bit of 40 µs; a shutdown and a sensor may follow."""
    case = next(case for case in CASES if case.board == "radds")
    host = case.host()
    free = [name for name in board_target("radds").chip.pins if name not in TAKEN]
    names: dict[str, str] = dict(zip((*SELECTS, "miso", "mosi", "clock"), free, strict=False))
    bus = f"miso_pin={names['miso']} mosi_pin={names['mosi']} sclk_pin={names['clock']}"
    host.send("allocate_oids count=4")
    for oid, select in enumerate(SELECTS):
        host.send(
            f"config_spi oid={oid} pin={names[select]} cs_active_high=0",
            f"spi_set_sw_bus oid={oid} {bus} mode={mode} pulse_ticks={20 * case.hz // 1_000_000}",
        )
    return case, host, names


class Answer(dict[int, int]):
    """The inputs of a chip: a device that puts its bits on one of them at the edges of its mode, a
    microsecond behind it: when the clock leaves its rest or, the first bit at the beginning, when
    it goes back to it."""

    def __init__(self, host: Host, names: dict[str, str], mode: int, data: str, hz: int) -> None:
        numbers = host.dictionary.enumerations["pin"]
        self._chip, self._pin, self._clock = (
            host.chip,
            numbers[names["miso"]],
            numbers[names["clock"]],
        )
        self._shifts_at = 1 - (mode >> 1) if mode & 1 else mode >> 1
        self._begins_at = mode & 1
        self._bits, self._delay = bits(data), hz // 1_000_000

    def items(self) -> Any:
        settled = self._chip.clock - self._delay
        edges = (e for e in self._chip.edges if e[1:] == (self._clock, self._shifts_at))
        shifts = sum(clock < settled for clock, _, _ in edges)
        at = shifts - self._begins_at
        return [(self._pin, int(0 <= at < len(self._bits) and self._bits[at]))]


@pytest.mark.parametrize("mode", [0, 1, 2, 3])
def test_bits_go_both_ways_at_the_edges_of_each_mode(mode: int) -> None:
    case, host, names = wired(mode)
    host.send("finalize_config crc=1")
    host.send("spi_send oid=0 data=00", seconds=0.01)  # the clock is at rest
    host.chip.edges.clear()
    host.chip.inputs = Answer(host, names, mode, "a5c3", case.hz)
    said = host.send("spi_transfer oid=1 data=53ca", seconds=0.01)["spi_transfer_response"]
    assert said["response"] == bytes.fromhex("a5c3")
    assert heard(host, names, mode) == [("second", bits("53ca"))]


@pytest.mark.parametrize("last_to", [0, 1], ids=["the-same", "another"])
@pytest.mark.parametrize("late_ms", [0.3, 0.7, 1.4])
def test_a_transfer_ends_before_the_last_message(late_ms: float, last_to: int) -> None:
    """Of 1.6 ms; a sensor that is out of its range is seen so long after it was asked for."""
    case, host, names = wired(0)
    us = case.hz // 1_000_000
    host.send(
        f"config_spi_shutdown oid=2 spi_oid={last_to} shutdown_msg={LAST}",
        f"config_analog_in oid=3 pin={case.sensor[0]}",
        "finalize_config crc=1",
    )
    host.chip.analog[case.sensor[1]] = 4000
    at = host.chip.clock + 20_000 * us
    host.send(
        f"query_analog_in oid=3 clock={at} sample_ticks={50 * us} sample_count=1"
        f" rest_ticks={10_000 * us} bytes_per_report=2 min_value=0 max_value=100"
        " range_check_count=1"
    )
    host.chip.run((at - host.chip.clock) / case.hz - late_ms / 1000)
    host.chip.edges.clear()
    host.send(f"spi_send oid=0 data={TRANSFER}", seconds=0.02)
    assert host.send("get_config")["config"]["is_shutdown"] == 1
    assert heard(host, names) == [("first", bits(TRANSFER)), (SELECTS[last_to], bits(LAST))]
