"""Checks that the chip of a board can have the configured console: the UART, its pins, and the baud
rate."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from passo.config.chips import Chip, Uart, chip
from passo.config.findings import Finding, array, number, table
from passo.config.toml_lines import Path

_AVR_CYCLES = 8  # clock cycles of an AVR per bit, times the divisor


def check_console(
    board: Mapping[str, Any], own: Mapping[str, Any], place: Path
) -> Iterator[Finding]:
    """Checks the console of a board that runs Passo's firmware on a supported chip. Pins of `board`
    are those of the chip. `own` is the board's table in the machine file, at the path `place`."""
    if not (console := table(board, "console")):
        return
    it, name = chip(str(board["mcu"])), console.get("uart")
    if uart := it.uarts.get(str(name)):
        yield from _check_pins(console, uart, (*place, "console", "pins"))
        hz = uart.hz or int((number(board, "clock_hz") or 0) / _AVR_CYCLES)
        yield from _check_bauds(board, own, place, it, hz)
    else:
        error = "config.missing-key" if name is None else "config.value"
        limit = f"one that the firmware speaks on: {', '.join(it.uarts)}"
        yield Finding(error, (*place, "console", "uart"), name, limit)


def _check_pins(console: Mapping[str, Any], uart: Uart, path: Path) -> Iterator[Finding]:
    pins, usable = array(console, "pins"), (uart.receive, uart.send)
    if len(pins) != 2 or any(pin not in names for pin, names in zip(pins, usable, strict=True)):
        receive, send = (" or ".join(names) for names in usable)
        limit = f"the pins that {console['uart']} receives and sends on: {receive}, then {send}"
        if pins:
            yield Finding("config.value", path, ", ".join(map(str, pins)), limit)
        else:
            yield Finding("config.missing-key", path, None, limit)


def _check_bauds(
    board: Mapping[str, Any], own: Mapping[str, Any], place: Path, it: Chip, hz: int
) -> Iterator[Finding]:
    console = table(board, "console")
    asked: dict[float | None, Path] = {number(console, "baud"): (*place, "console", "baud")}
    if "baud" in own:
        asked[number(board, "baud")] = (*place, "baud")
    for baud, path in asked.items():
        if baud and baud >= 1 and hz > 0 and not makes(hz, it.uart_divisor, int(baud)):
            rates = " and ".join(map(str, rates_near(hz, it.uart_divisor, int(baud))))
            limit = f"a baud rate that its {it.name} makes within 2.5 %, the nearest: {rates}"
            yield Finding("config.value", path, baud, limit)


def makes(hz: int, least: int, baud: int) -> bool:
    """Whether a UART that divides `hz` by a whole number of at least `least` can make the baud
    rate, as set up by the firmware."""
    divisor = (2 * hz + baud) // (2 * baud)
    return divisor >= least and abs(hz // divisor - baud) < baud // 40


def rates_near(hz: int, least: int, baud: int) -> list[int]:
    """The possible rates of the UART next to `baud`, slower and faster, or the fastest rate."""
    divisor = hz // baud
    return [hz // (divisor + 1), hz // divisor] if divisor >= least else [hz // least]
