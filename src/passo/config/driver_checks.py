"""Checks of motor drivers with registers: each has its own address, and supports its current.

Like the other checks they read raw tables.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from passo.config.board_files import pin_of
from passo.config.findings import Finding, did_you_mean, number, table, tables
from passo.config.klippers_firmware import runs_klippers
from passo.config.pin_names import bare, placed, section
from passo.config.toml_lines import Path
from passo.config.trinamic import CHIPS, ChipName, chip_of

Raw = Mapping[str, Any]

_UART_KEYS = ("uart_pin", "tx_pin", "address")
_WIRES = ("clock_pin", "mosi_pin", "miso_pin")
_SPI_KEYS = ("cs_pin", *_WIRES)
_CURRENTS = ("run_current_a", "hold_current_a")
# Keys of thresholds, without their unit, and the fields that hold them.
_SPEEDS = {
    "stealthchop_below": "tpwmthrs",
    "coolstep_above": "tcoolthrs",
    "high_speed_above": "thigh",
}
_RESISTORS = ("sense_resistor_ohm", "reference_resistor_ohm")


@dataclass(frozen=True, slots=True)
class _Wire:
    """The one-wire UART of the driver at `path`. Pins are in the form of `pin_of`, without marks;
    `sent_on` is as in the file."""

    path: Path
    chip: ChipName
    receives: tuple[str, str]
    sends: tuple[str, str]
    sent_on: str


def check_drivers(data: Raw) -> Iterator[Finding]:
    """Checks all motors with a table `tmc`."""
    uarts: list[tuple[Path, ChipName, Raw]] = []
    for name, stepper in tables(data, "steppers"):
        if "tmc" not in stepper:
            continue
        path: Path = ("steppers", name, "tmc")
        tmc = table(stepper, "tmc")
        chip = chip_of(stepper.get("driver"))
        if chip is None:
            given = stepper.get("driver", "A4988")
            limit = f"one of {', '.join(CHIPS)}, for the motor has a table tmc"
            hint = did_you_mean(given, CHIPS)
            yield Finding("config.value", ("steppers", name, "driver"), given, limit, hint)
            continue
        yield from _check_keys(data, stepper, tmc, chip, path)
        yield from _check_currents(tmc, chip, path)
        yield from _check_registers(tmc, chip, path)
        if isinstance(tmc.get("uart_pin"), str):
            uarts.append((path, chip, tmc))
    yield from _check_uarts(data, uarts)


def _check_uarts(data: Raw, uarts: list[tuple[Path, ChipName, Raw]]) -> Iterator[Finding]:
    """Checks that drivers on one UART have equal descriptions of it, and different addresses. Some
    chips have one address."""
    wires: dict[tuple[str, str], _Wire] = {}
    senders: dict[tuple[str, str], _Wire] = {}
    addresses: dict[tuple[tuple[str, str], float], _Wire] = {}
    for path, chip, tmc in uarts:
        own = _wire(data, path, chip, tmc)
        first = wires.setdefault(own.receives, own)
        sender = senders.setdefault(own.sends, own) if "tx_pin" in tmc else own
        owner = addresses.setdefault((own.receives, number(tmc, "address") or 0), own)
        if owner is not own and 1 in (CHIPS[chip].addresses, CHIPS[owner.chip].addresses):
            limit, value = "a pin of its own: it belongs to", tmc["uart_pin"]
            yield Finding("config.conflict", (*path, "uart_pin"), value, limit, owner=owner.path)
        elif first.sends != own.sends:
            code = "config.conflict" if "tx_pin" in tmc else "config.missing-key"
            limit, value = f"{first.sent_on}, on which this wire sends at", tmc.get("tx_pin")
            yield Finding(code, (*path, "tx_pin"), value, limit, owner=first.path)
        elif sender.receives != own.receives:
            limit = "a pin of its own: it belongs to the wire of"
            value = tmc["tx_pin"]
            yield Finding("config.conflict", (*path, "tx_pin"), value, limit, owner=sender.path)
        elif owner is not own:
            limit, value = "an address of its own: it belongs to", tmc.get("address", 0)
            yield Finding("config.conflict", (*path, "address"), value, limit, owner=owner.path)


def _wire(data: Raw, path: Path, chip: ChipName, tmc: Raw) -> _Wire:
    received_on, given = str(tmc["uart_pin"]), tmc.get("tx_pin")
    sent_on = given if isinstance(given, str) else received_on
    (board, receives), (_, sends) = pin_of(data, received_on), pin_of(data, sent_on)
    return _Wire(path, chip, (board, bare(receives)), (board, bare(sends)), bare(sent_on))


def by_uart(chip: ChipName, tmc: Raw) -> bool:
    """Whether the driver is on a UART; a chip with both buses is on that of its pins."""
    buses = CHIPS[chip].buses
    return "uart" in buses and (len(buses) == 1 or "uart_pin" in tmc)


def _check_keys(data: Raw, stepper: Raw, tmc: Raw, chip: ChipName, path: Path) -> Iterator[Finding]:
    uart = by_uart(chip, tmc)
    for key in (*_SPI_KEYS, "spi_bus") if uart else _UART_KEYS:
        if key in tmc:
            limit = f"{'uart_pin' if uart else ', '.join(_SPI_KEYS)} for a {chip}"
            yield Finding("config.conflict", (*path, key), tmc[key], limit)
    wanted = ("uart_pin",) if uart else ("cs_pin",) if "spi_bus" in tmc else _SPI_KEYS
    board, word = placed(str(stepper.get("socket")))
    socket = table(data, *section(board), "sockets", word)
    for key in wanted:
        if key not in tmc and not (key == "cs_pin" and "select" in socket):
            yield Finding("config.missing-key", (*path, key), None, f"a pin, for a {chip}")
    if "spi_bus" in tmc and not uart:
        yield from _check_bus(data, tmc, path)
    if CHIPS[chip].addresses == 1 and "address" in tmc:
        limit = f"no address: that of a {chip} is 0"
        yield Finding("config.conflict", (*path, "address"), tmc["address"], limit)
    address, most = number(tmc, "address") or 0, CHIPS[chip].addresses - 1
    if most > 0 and address > most:
        yield Finding(
            "config.value", (*path, "address"), tmc["address"], f"0 to {most} for a {chip}"
        )
    if not CHIPS[chip].currents.hold and "hold_current_a" in tmc:
        limit = f"no such key: a {chip} has one current, also at standstill"
        yield Finding("config.conflict", (*path, "hold_current_a"), tmc["hold_current_a"], limit)
    for speed, field in _SPEEDS.items():
        for key in (f"{speed}_mm_s", f"{speed}_deg_s"):
            if key in tmc and not CHIPS[chip].field(field):
                limit = f"no such key: a {chip} does not have it"
                yield Finding("config.conflict", (*path, key), tmc[key], limit)
    wrong = _RESISTORS[chip != "TMC2240"]
    if wrong in tmc:
        limit = f"{_RESISTORS[chip == 'TMC2240']} for a {chip}"
        yield Finding("config.conflict", (*path, wrong), tmc[wrong], limit)


def _check_bus(data: Raw, tmc: Raw, path: Path) -> Iterator[Finding]:
    """Checks that a bus has no pins, and is one of Klipper's firmware."""
    for key in _WIRES:
        if key in tmc:
            yield Finding(
                "config.conflict", (*path, key), tmc[key], "no such key: spi_bus has the pins"
            )
    if not runs_klippers(table(data, *section(placed(str(tmc["spi_bus"]))[0]))):
        limit = f"no such key: Passo's firmware has no buses; give {', '.join(_WIRES)}"
        yield Finding("config.conflict", (*path, "spi_bus"), tmc["spi_bus"], limit)


def _check_currents(tmc: Raw, chip: ChipName, path: Path) -> Iterator[Finding]:
    key = _RESISTORS[chip == "TMC2240"]
    law = CHIPS[chip].currents
    resistor = number(tmc, key) or law.resistor_ohm
    if resistor <= 0:
        return
    least_a, most_a = law.least_ma(resistor) / 1000, law.largest_ma(resistor) / 1000
    for current in _CURRENTS:
        ampere = number(tmc, current)
        if ampere is not None and not least_a <= ampere <= most_a:
            what = key.removesuffix("_ohm").replace("_", " ")
            limit = f"{least_a:g} to {most_a:g} A with a {what} of {resistor:g} ohm"
            yield Finding("config.value", (*path, current), ampere, limit)


def _check_registers(tmc: Raw, chip: ChipName, path: Path) -> Iterator[Finding]:
    """Checks that the chip has the fields, that no other key sets them, and that their values
    fit."""
    settable = CHIPS[chip].settable
    for name, value in table(tmc, "registers").items():
        where = (*path, "registers", name)
        owner = CHIPS[chip].owner(name)
        if owner:
            limit = f"no such field: {owner} of tmc set it"
            yield Finding("config.conflict", where, value, limit)
        elif name not in settable:
            limit = f"a field of a {chip}: {', '.join(sorted(settable))}"
            yield Finding("config.conflict", where, value, limit, did_you_mean(name, settable))
        elif isinstance(value, int) and not isinstance(value, bool):
            least, most = CHIPS[chip].bounds(name)
            if not least <= value <= most:
                limit = f"{least} to {most}"
                yield Finding(
                    "config.value", where, value, limit, nearest=max(least, min(value, most))
                )


def check_thresholds(stepper: Raw, path: Path, turns: bool) -> Iterator[Finding]:
    """Checks that the thresholds of speed are in the unit of the motor."""
    right, wrong = ("deg", "mm") if turns else ("mm", "deg")
    for speed in _SPEEDS:
        key = f"{speed}_{wrong}_s"
        value = table(stepper, "tmc").get(key)
        if value is not None:
            limit = f"{speed}_{right}_s here"
            yield Finding("config.conflict", (*path, "tmc", key), value, limit)
