"""Drivers with registers, from the host through the board's wires to simulated chips."""

from __future__ import annotations

import random
from collections.abc import Container
from dataclasses import replace

import pytest
from tests.support import trinamic_registers as r
from tests.support.link_bench import HZ, Bench, Kind, LateLink, description

from passo.board.description import Driver, SpiPins, UartPins
from passo.board.drivers import Drivers
from passo.board.trinamic import DriverSettings, Reading, findings
from passo.config.trinamic import CHIPS, ChipName
from passo.errors import MachineError

Wires = dict[ChipName, UartPins | SpiPins]
WIRES: Wires = {
    "TMC2208": UartPins("^PG0", "PG0"),
    "TMC2209": UartPins("^PG0", "PG1"),
    "TMC2130": SpiPins("PG2", "PG3", "PG4", "PG5"),
    "TMC5160": SpiPins("PG2", "PG3", "PG4", "PG5"),
    "TMC2240": SpiPins("PG2", "PG3", "PG4", "PG5"),
    "TMC2660": SpiPins("PG2", "PG3", "PG4", "PG5"),
}
REPORTS = {
    chip: "tmcuart_response" if isinstance(wire, UartPins) else "spi_transfer_response"
    for chip, wire in WIRES.items()
}


@pytest.fixture(params=["virtual", "passo"], autouse=True)
def firmware(request: pytest.FixtureRequest):
    before, Kind.firmware = Kind.firmware, request.param
    yield
    Kind.firmware = before


def flags(chip: ChipName) -> int:
    """The flags of standstill and of a high temperature, a TMC2660's of overheating."""
    return 0x82 if chip == "TMC2660" else 0x8000_0001


def is_set_up(made: Bench, drivers: Drivers) -> bool:
    settings = drivers.states["x"].settings
    address = CHIPS[settings.chip].registers["CHOPCONF"].address
    return made.simulated.drivers["x"].read(address) == settings.registers()["CHOPCONF"]


def driver_settings(chip: ChipName, **settings) -> DriverSettings:
    return DriverSettings(chip, 0.9, 0.45, CHIPS[chip].currents.resistor_ohm, **settings)


def bench(*chips: ChipName, wires: Wires | None = None, **settings) -> tuple[Bench, Drivers]:
    named = zip(("x", "y"), chips, strict=False)
    drivers = tuple(
        Driver(name, (wires or WIRES)[chip], driver_settings(chip, **settings), address)
        for address, (name, chip) in enumerate(named)
    )
    made = Bench(replace(description(), drivers=drivers))
    return made, Drivers(made.connection)


@pytest.mark.parametrize("chip", WIRES)
def test_driver_registers_have_the_settings(chip: ChipName):
    made, drivers = bench(chip)
    drivers.configure()
    state = drivers.states["x"]
    assert state.failure is None
    simulated = made.simulated.drivers["x"]
    registers = CHIPS[chip].registers
    for name, value in state.settings.registers().items():
        assert simulated.read(registers[name].address) == value, name
    if "GSTAT" in registers:
        assert simulated.read(r.GSTAT) == 0


def test_a_tmc2240_has_a_uart_too():
    made, drivers = bench("TMC2240", wires={"TMC2240": UartPins("^PG0", "PG1")})
    drivers.configure()
    assert failure(drivers) == ""
    assert made.simulated.drivers["x"].read(0x0A) == 1  # CURRENT_RANGE of 0.9 A
    drivers.begin_status("x")
    passes(made, drivers, 1)
    reading = drivers.states["x"].reading
    assert reading is not None
    assert reading.temperature_c == pytest.approx(24.9, abs=0.1)
    assert reading.supply_v == pytest.approx(24.0, abs=0.1)


def test_settings_are_written_while_questions_follow_without_a_gap():
    made, drivers = bench("TMC2209")
    written = drivers.begin_configure("x")
    for _ in range(100):
        drivers.begin_status("x")  # the line is never idle
        if written():
            break
        passes(made, drivers, 0.02)
    assert written() and is_set_up(made, drivers)
    assert not drivers.idle


@pytest.mark.parametrize("chip", WIRES)
def test_a_change_writes_only_the_registers_that_differ(chip: ChipName):
    made, drivers = bench(chip)
    drivers.configure()
    simulated, registers = made.simulated.drivers["x"], CHIPS[chip].registers
    chopper, current = registers["CHOPCONF"], CHIPS[chip].field(CHIPS[chip].currents.run)
    assert current is not None
    simulated.set(chopper.address, 0x123)
    drivers.begin_change("x", replace(drivers.states["x"].settings, run_a=0.8))
    read: list[int] = []
    drivers.begin_read("x", CHIPS[chip].status.name, read.append)
    passes(made, drivers, 1)
    assert failure(drivers) == ""
    assert len(read) == 1
    wanted = driver_settings(chip)
    wanted = replace(wanted, run_a=0.8).registers()[current.register]
    assert simulated.read(registers[current.register].address) == wanted
    assert simulated.read(chopper.address) == 0x123


@pytest.mark.parametrize("chip", ["TMC2209", "TMC5160", "TMC2240"])
def test_a_fault_after_the_status_was_read_has_its_name(chip: ChipName):
    made, drivers = bench(chip)
    drivers.configure()
    simulated = made.simulated.drivers["x"]
    short = 1 << CHIPS[chip].status.fields["s2gb"].low
    simulated.set_after_read(r.DRV_STATUS, short)
    simulated.set(r.GSTAT, 2)
    drivers.begin_status("x")
    passes(made, drivers, 1)
    reading = drivers.states["x"].reading
    assert reading is not None
    assert [f.problem.code for f in findings("x", chip, reading)] == ["driver.short-to-ground"]


class LosingLink:
    """A link that loses the reports of one kind whose numbers are among these."""

    def __init__(self, bench: Bench, report: str, lost: Container[int]) -> None:
        self._link, self._report, self._lost = bench.link, report, lost
        self.seen = 0

    def __getattr__(self, name: str):
        return getattr(self._link, name)

    def take_responses(self):
        return [m for m in self._link.take_responses() if m[0] != self._report or self._arrives()]

    def _arrives(self) -> bool:
        self.seen += 1
        return self.seen - 1 not in self._lost


class SpoilingLink(LosingLink):
    """One whose SPI device has the lowest bits of one answer wrong."""

    def __init__(self, bench: Bench, spoilt: int) -> None:
        super().__init__(bench, REPORTS["TMC2130"], (spoilt,))

    def take_responses(self):
        taken = self._link.take_responses()
        for name, values in taken:
            if name == self._report and not self._arrives():
                values["response"] = values["response"][:-1] + b"\7"
        return taken


@pytest.mark.parametrize("chip", WIRES)
def test_any_lost_answer_during_setup_is_recovered(chip: ChipName):
    """Of SPI an answer is that to the question before; by UART the chip counts what it was told."""
    lost, seen = 0, 1
    while lost < seen:
        made, drivers = bench(chip)
        made.connection.link = link = LosingLink(made, REPORTS[chip], (lost,))
        drivers.require()
        for register, value in drivers.states["x"].settings.writes():
            if register != r.GSTAT:
                assert made.simulated.drivers["x"].read(register) == value, (lost, hex(register))
        lost, seen = lost + 1, link.seen
    assert lost > len(drivers.states["x"].settings.registers())


@pytest.mark.parametrize("chip", WIRES)
def test_dead_link_is_not_reported_as_driver_failure(chip: ChipName):
    made, drivers = bench(chip)
    made.connection.link = LosingLink(made, REPORTS[chip], range(1, 1000))
    with pytest.raises(MachineError, match=f"does not answer {REPORTS[chip][:3]}"):
        drivers.require()
    assert drivers.states["x"].failure is None


@pytest.mark.parametrize("chip", WIRES)
def test_setup_succeeds_if_half_of_all_answers_are_lost(chip: ChipName):
    """What was answered is not asked again for the sake of what was not."""
    made, drivers = bench(chip)
    rng = random.Random(3)
    made.connection.link = link = LosingLink(
        made, REPORTS[chip], [i for i in range(1000) if rng.random() < 0.5]
    )
    drivers.require()
    for register, value in drivers.states["x"].settings.writes():
        if register != r.GSTAT:
            assert made.simulated.drivers["x"].read(register) == value, hex(register)
    assert link.seen < 90


def failure(drivers: Drivers, name: str = "x") -> str:
    found = drivers.states[name].failure
    return "" if found is None else found.problem.code


def passes(made: Bench, drivers: Drivers, seconds: float) -> None:
    """Time passes, with a look at the drivers every 10 ms."""
    for _ in range(round(seconds * 100)):
        made.run(0.01)
        drivers.poll()


@pytest.mark.parametrize("chip", WIRES)
def test_no_device_answers(chip: ChipName):
    made, drivers = bench(chip)
    made.simulated.drivers["x"].plugged = False
    drivers.configure()
    assert failure(drivers) == "driver.silent"
    assert ("PG0" if chip in ("TMC2208", "TMC2209") else "PG2") in str(drivers.states["x"].failure)


def test_require_reports_each_driver_that_fails():
    made, drivers = bench("TMC2209", "TMC2209")
    drivers.require()
    for chip in made.simulated.drivers.values():
        chip.plugged = False
    with pytest.raises(MachineError) as caught:
        drivers.require()
    assert [p.values["axis"] for p in caught.value.problems] == ["x", "y"]


@pytest.mark.parametrize(
    ("chip", "other"), [("TMC2208", 0x21), ("TMC2209", 0x20), ("TMC2130", 0x30), ("TMC5160", 0x11)]
)
def test_wrong_chip_is_named_and_not_configured(chip: ChipName, other: int):
    made, drivers = bench(chip)
    simulated = made.simulated.drivers["x"]
    simulated.set(CHIPS[chip].registers["IOIN"].address, other << 24)
    drivers.configure()
    assert failure(drivers) == "driver.other-chip"
    assert f"0x{other:02x}" in str(drivers.states["x"].failure)
    assert simulated.read(r.IHOLD_IRUN) == 0


@pytest.mark.parametrize("damaged", range(1, 5))
@pytest.mark.parametrize("chip", WIRES)
def test_damaged_answers_are_asked_for_again(chip: ChipName, damaged: int):
    made, drivers = bench(chip)
    made.simulated.drivers["x"].damaged_answers = damaged
    drivers.configure()
    assert failure(drivers) == ""
    assert is_set_up(made, drivers)
    made.simulated.drivers["x"].damaged_answers = damaged
    drivers.begin_status("x")
    passes(made, drivers, 1)
    assert drivers.states["x"].reading is not None
    assert drivers.states["x"].reading.status == 0


def test_two_drivers_on_one_wire_are_distinguished():
    made, drivers = bench("TMC2209", "TMC2209")
    drivers.configure()
    drivers.begin_configure("y", replace(drivers.states["y"].settings, run_a=0.3))
    passes(made, drivers, 1)
    chips = made.simulated.drivers
    assert [chips[n].read(r.IHOLD_IRUN) for n in "xy"] == [0x81C0E, 0x8090E]


@pytest.mark.parametrize("chip", WIRES)
def test_driver_status_is_polled(chip: ChipName):
    made, drivers = bench(chip)
    drivers.configure()
    made.simulated.drivers["x"].set(CHIPS[chip].status.address, flags(chip))
    drivers.begin_status("x")
    assert not drivers.idle
    passes(made, drivers, 0.3)
    assert drivers.idle
    state = drivers.states["x"]
    assert state.fresh and state.reading is not None
    assert (state.reading.gstat, state.reading.status) == (0, flags(chip))


@pytest.mark.parametrize("chip", ["TMC2208", "TMC2209"])
def test_timeout_counts_time_of_slow_board_with_fast_one(chip: ChipName):
    made, drivers = bench(chip)
    drivers.configure()
    # Time is told by the main board's clock, here eleven times as fast.
    made.connection.board = replace(made.board, clock_hz=HZ // 11)
    made.connection.link = LateLink(made, REPORTS[chip], 0.25)
    drivers.begin_status("x")
    passes(made, drivers, 6.0)
    assert drivers.idle
    assert failure(drivers) == ""
    assert drivers.states["x"].fresh


@pytest.mark.parametrize("chip", WIRES)
def test_unplugged_driver_is_set_up_when_it_is_back(chip: ChipName):
    made, drivers = bench(chip)
    drivers.configure()
    simulated = made.simulated.drivers["x"]
    simulated.plugged = False
    drivers.begin_status("x")
    passes(made, drivers, 1)
    assert failure(drivers) == "driver.silent"
    simulated.power_on()
    simulated.plugged = True
    drivers.begin_configure("x")
    passes(made, drivers, 1)
    assert failure(drivers) == ""
    assert is_set_up(made, drivers)


@pytest.mark.parametrize("chip", WIRES)
def test_lost_driver_answer_is_requested_again(chip: ChipName):
    made, drivers = bench(chip)
    drivers.configure()
    made.simulated.drivers["x"].set(CHIPS[chip].status.address, flags(chip))
    drivers.begin_status("x")
    for _ in range(3 if chip == "TMC2660" else 8):
        drivers.poll()
        made.run(0.1)
        assert len(made.connection.take_responses("tmcuart_response", "spi_transfer_response")) == 1
        drivers.poll()  # the board has the question: now it is waited for
        made.run(0.5)
    passes(made, drivers, 3)
    assert failure(drivers) == ""
    reading = drivers.states["x"].reading
    assert reading is not None and (reading.gstat, reading.status) == (0, flags(chip))


@pytest.mark.parametrize("chip", [chip for chip in WIRES if chip != "TMC2660"])
@pytest.mark.parametrize("lost", range(4))
def test_a_reset_is_reported_though_an_answer_is_lost(chip: ChipName, lost: int):
    """A TMC2130 forgets it as it tells of it."""
    made, drivers = bench(chip)
    drivers.configure()
    made.simulated.drivers["x"].power_on()
    made.connection.link = LosingLink(made, REPORTS[chip], (lost,))
    drivers.begin_status("x")
    passes(made, drivers, 3)
    reading = drivers.states["x"].reading
    assert reading is not None and reading.gstat == 1


@pytest.mark.parametrize("chip", ["TMC2130", "TMC5160"])
@pytest.mark.parametrize("spoilt", range(8))
def test_one_damaged_answer_by_spi_is_not_a_fault(chip: ChipName, spoilt: int):
    made, drivers = bench(chip)
    drivers.configure()
    made.connection.link = SpoilingLink(made, spoilt)
    drivers.begin_status("x")
    passes(made, drivers, 1)
    assert drivers.states["x"].reading == Reading(0, 0)
