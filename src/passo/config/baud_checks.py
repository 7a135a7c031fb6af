"""Whether the chip of a board makes the baud rates that its console is to have."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from passo.config.chips import chip, chip_names
from passo.config.findings import Finding, number, table
from passo.config.lines import Path

_AVR_CYCLES = 8  # a bit lasts so many of an AVR's clock, times its divisor


def check_bauds(board: Mapping[str, Any], own: Mapping[str, Any], place: Path) -> Iterator[Finding]:
    """The rates of a board that runs Passo's firmware. `own` is what the machine file says of it,
    at `place`."""
    mcu, console = board.get("mcu"), table(board, "console")
    if mcu not in chip_names() or board.get("base") == "klipper":
        return
    it, clock_hz = chip(str(mcu)), number(board, "clock_hz")
    avr_hz = int((clock_hz or 0) / _AVR_CYCLES) if it.core == "avr" else 0
    hz = it.uarts.get(str(console.get("uart")), avr_hz)
    asked: dict[float | None, Path] = {number(console, "baud"): (*place, "console", "baud")}
    if "baud" in own:
        asked[number(board, "baud")] = (*place, "baud")
    for baud, path in asked.items():
        if baud and baud >= 1 and hz > 0 and not makes(hz, it.uart_divisor, int(baud)):
            rates = " and ".join(map(str, rates_near(hz, it.uart_divisor, int(baud))))
            limit = f"a baud rate that its {it.name} makes within 2.5 %, the nearest: {rates}"
            yield Finding("config.value", path, baud, limit)


def makes(hz: int, least: int, baud: int) -> bool:
    """Whether a UART that divides `hz` by whole numbers from `least` on makes the rate, as the
    firmware sets it up."""
    divisor = (2 * hz + baud) // (2 * baud)
    return divisor >= least and abs(hz // divisor - baud) < baud // 40


def rates_near(hz: int, least: int, baud: int) -> list[int]:
    """The UART's rates next to `baud`, slower and faster, or the fastest of all."""
    divisor = hz // baud
    return [hz // (divisor + 1), hz // divisor] if divisor >= least else [hz // least]
