"""The wires of chips on a simulated board."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

from passo.board.description import BoardDescription, I2cPins, SpiPins

_Wire = TypeVar("_Wire")


def without_buses(board: BoardDescription) -> BoardDescription:
    """The same board, on which each bus of the chip's hardware is made on pins of its own: a
    simulated chip has no such buses, but as many pins as it needs."""
    accelerometers = tuple(replace(a, wire=_on_pins(a.wire)) for a in board.accelerometers)
    drivers = tuple(replace(d, wire=_on_pins(d.wire)) for d in board.drivers)
    sensors = tuple(replace(s, wire=_on_pins(s.wire)) for s in board.i2c_sensors)
    eddies = tuple(replace(e, wire=_on_pins(e.wire)) for e in board.eddies)
    return replace(
        board,
        accelerometers=accelerometers,
        drivers=drivers,
        i2c_sensors=sensors,
        eddies=eddies,
    )


def _on_pins(wire: _Wire) -> _Wire | SpiPins | I2cPins:
    if isinstance(wire, SpiPins) and wire.bus:
        select = wire.cs_pin or f"{wire.bus}_cs"
        clock, mosi, miso = (f"{wire.bus}_{name}" for name in ("sclk", "mosi", "miso"))
        return SpiPins(select, clock, mosi, miso, wire.mode, wire.hz)
    if isinstance(wire, I2cPins) and wire.bus:
        return I2cPins(f"{wire.bus}_scl", f"{wire.bus}_sda", wire.address, wire.hz)
    return wire
