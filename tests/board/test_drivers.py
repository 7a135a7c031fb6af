"""Drivers with registers, from the host through the board's wires to simulated chips."""

from __future__ import annotations

from dataclasses import replace

import pytest
from tests.board.bench import Bench, Kind, description

from passo.board.description import Driver, SpiPins, UartPins
from passo.board.drivers import Drivers
from passo.board.trinamic import DriverSettings
from passo.board.trinamic import registers as r
from passo.config.trinamic import ChipName

WIRES: dict[ChipName, UartPins | SpiPins] = {
    "TMC2208": UartPins("^PG0", "PG0"),
    "TMC2209": UartPins("^PG0", "PG1"),
    "TMC2130": SpiPins("PG2", "PG3", "PG4", "PG5"),
    "TMC5160": SpiPins("PG2", "PG3", "PG4", "PG5"),
}
EXPECTED = {
    "TMC2208": {
        r.GCONF: 0b1_1100_0100,
        r.SLAVECONF: 0x200,
        r.IHOLD_IRUN: 0x80F1F,
        r.TPOWERDOWN: 20,
        r.TPWMTHRS: 0,
        r.PWMCONF: 0xC10D0024,
        r.CHOPCONF: 0x140300C3,
    },
}


@pytest.fixture(params=["virtual", "passo"], autouse=True)
def firmware(request: pytest.FixtureRequest):
    before, Kind.firmware = Kind.firmware, request.param
    yield
    Kind.firmware = before


def bench(*chips: ChipName, **settings) -> tuple[Bench, Drivers]:
    named = zip(("x", "y"), chips, strict=False)
    drivers = tuple(
        Driver(name, WIRES[chip], DriverSettings(chip, 0.9, 0.45, 0.11, **settings), address)
        for address, (name, chip) in enumerate(named)
    )
    made = Bench(replace(description(), drivers=drivers))
    return made, Drivers(made.connection)


@pytest.mark.parametrize("chip", WIRES)
def test_settings_arrive(chip: ChipName):
    made, drivers = bench(chip)
    drivers.configure()
    state = drivers.states["x"]
    assert state.failure is None
    simulated = made.simulated.drivers["x"]
    for register, value in state.settings.writes():
        if register != r.GSTAT:
            assert simulated.read(register) == value, hex(register)
    assert simulated.read(r.GSTAT) == 0
