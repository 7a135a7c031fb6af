"""Kalico, a host of another house, drives boards that run the firmware, at the other end of a pty.
Its words for analog inputs are those of older hosts, so the firmware is built for them. Host and
board have a clock of their own, so that neither is late on a busy computer."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from tests.firmware.library import (
    library_for_older_hosts,
    process_for_older_hosts,
)
from tests.firmware.simavr.bench import AvrBench
from tests.firmware.simavr.boards import RAMPS, image
from tests.firmware.simavr.host import Hotend
from tests.hosts.boards import AvrOnPty, Moved, ProcessBoard, PtyBoard
from tests.hosts.kalico import Kalico
from tests.hosts.shared_clock import SharedClock, SharedLine
from tests.support import trinamic_registers as r
from tests.support.driver_machine import machine_text
from tests.support.edited_machine import edited

from passo import config
from passo.config.machine import MachineConfig
from passo.config.trinamic import ChipName
from passo.printer.setup.boards import board_description, board_descriptions
from passo.printer.setup.simulated_world import simulated_board, simulated_machine
from passo.simulator import SimulatedBoard
from passo.simulator import dictionary as simulated
from passo.toolchain.readback import identify

HERE = Path(__file__).parent
PRINT = """\
G1 X50 Y40 Z2 F9000
G92 E0
G1 X60 Y60 E2 F1800
G1 X20 E5
G1 Y50.0125 E5.5
G1 X45.6 Y57.3 Z2.4 F6000
"""
NET = {"x": -352, "y": 1384, "z": 160, "e": 525}  # of all but the first line
MADE = {"x": 800 + 3200 + 2048, "y": 1600 + 799 + 583, "z": 160, "e": 525}

CONVERTER = """sensor_pin = "D31"
sensor = { kind = "max31855", clock_pin = "D33", mosi_pin = "D35", miso_pin = "D37" }
"""
THERMOCOUPLE = """\
sensor_type: MAX31855
sensor_pin: PC6
spi_software_sclk_pin: PC4
spi_software_mosi_pin: PC2
spi_software_miso_pin: PC0
"""
DRIVERS = """
[tmc2209 stepper_x]
uart_pin: ^PG1
sense_resistor: 0.11
run_current: 0.8

[tmc2209 stepper_y]
uart_pin: ^PG1
uart_address: 1
sense_resistor: 0.11
run_current: 0.8

[tmc2208 stepper_z]
uart_pin: PL7
tx_pin: PL5
sense_resistor: 0.11
run_current: 0.6

[tmc5160 extruder]
cs_pin: PA1
spi_software_sclk_pin: PA3
spi_software_mosi_pin: PA5
spi_software_miso_pin: PA7
sense_resistor: 0.075
run_current: 1.2
"""

MASS = """
[simulated.masses.x]
frequency_hz = 48.0
damping = 0.1
"""
TESTER = """
[resonance_tester]
probe_points: 100, 100, 20
"""
# The accelerometer for Passo and for Kalico.
SPI = (
    """
[accelerometer]
cs_pin = "D40"
clock_pin = "D42"
mosi_pin = "D59"
miso_pin = "D64"
""",
    """
accel_chip: adxl345

[adxl345]
cs_pin: PG1
spi_software_sclk_pin: PL7
spi_software_mosi_pin: PF5
spi_software_miso_pin: PK2
""",
)
I2C = (
    """
[accelerometer]
chip = "lis2dw"
scl_pin = "D40"
sda_pin = "D42"
""",
    """
accel_chip: lis2dw

[lis2dw]
i2c_software_scl_pin: PG1
i2c_software_sda_pin: PL7
""",
)


@pytest.fixture
def clock(tmp_path: Path) -> SharedClock:
    return SharedClock(tmp_path)


@pytest.fixture
def configuration() -> str:
    """What Kalico is told of the machine."""
    return (HERE / "kalico.cfg").read_text(encoding="utf-8")


def homes_and_prints(kalico: Kalico, board: PtyBoard, clock: SharedClock) -> None:
    def stands() -> dict[str, Moved]:
        kalico.tell("M400")
        clock.pass_s(0.1)  # what Kalico takes for the board's clock may be ahead of it
        return board.moved()

    kalico.tell("G28")
    first, *rest = PRINT.splitlines()
    kalico.tell(first)
    before = stands()
    for axis, steps in (("x", 4000), ("y", 3200), ("z", 800)):
        assert -2 <= before[axis].position - steps <= 0
    for line in rest:
        kalico.tell(line)
    after = stands()
    assert {a: after[a].position - before[a].position for a in after} == NET
    assert {a: after[a].steps - before[a].steps for a in after} == MADE
    assert re.search(r"B:2[45]\.\d /0\.0 T0:2[45]\.\d /0\.0", kalico.tell("M105"))


class TestProcess:
    """The firmware as a process of its own."""

    @pytest.fixture
    def board(self, tmp_path: Path, clock: SharedClock) -> Iterator[ProcessBoard]:
        board = ProcessBoard(process_for_older_hosts(), tmp_path, clock)
        yield board
        board.close()

    def test_kalico_homes_and_prints(self, hosts, tmp_path, clock, board, configuration):
        with Kalico(hosts, tmp_path, board.path, configuration, clock) as kalico:
            homes_and_prints(kalico, board, clock)

    def test_kalico_identifies_board_in_real_time(self, tmp_path):
        board = ProcessBoard(process_for_older_hosts(), tmp_path)
        found = asyncio.run(identify(board.path, 250_000))
        board.close()
        assert found is not None and found.dictionary is not None
        assert found.dictionary.version == "test"


class TestAvr:
    """The image of an ATmega2560 in a simulator that is exact to the cycle."""

    @pytest.fixture
    def board(self, tmp_path: Path, clock: SharedClock) -> Iterator[AvrOnPty]:
        board = AvrOnPty(AvrBench(image(replace(RAMPS, older_hosts=True)).elf), clock)
        yield board
        board.close()

    def test_kalico_homes_prints_and_heats(self, hosts, tmp_path, clock, board, configuration):
        bench = board.bench
        sensor = board_description(config.load("i3")).sensors[0]
        hotend = Hotend(bench, "PB4", 13, sensor)
        board.look(lambda: board.world.append(hotend))
        with Kalico(hosts, tmp_path, board.path, configuration, clock) as kalico:
            homes_and_prints(kalico, board, clock)
            kalico.tell("M104 S200")
            clock.pass_s(2)
            assert board.look(lambda: hotend.celsius) > 30
        # Nobody renews the heater any more.
        clock.pass_s(4)
        assert board.look(lambda: bench.level("PB4")) == 0
        before = board.look(lambda: bench.high_cycles("PB4"))
        clock.pass_s(0.5)
        assert board.look(lambda: bench.high_cycles("PB4")) == before


class TestDrivers:
    """Drivers with registers and a thermocouple, on all wires that the firmware has."""

    @pytest.fixture
    def machine(self) -> MachineConfig:
        return config.load_text(machine_text().replace('sensor_pin = "T0"\n', CONVERTER, 1))

    @pytest.fixture
    def configuration(self) -> str:
        text = (HERE / "kalico.cfg").read_text(encoding="utf-8")
        begin = text.index("sensor_type")
        end = text.index("control: pid")
        return f"{text[:begin]}{THERMOCOUPLE}{text[end:]}{DRIVERS}"

    @pytest.fixture
    def board(
        self, tmp_path: Path, machine: MachineConfig, monkeypatch: pytest.MonkeyPatch
    ) -> SimulatedBoard:
        library = library_for_older_hosts()
        monkeypatch.setattr(simulated, "firmware_library", lambda: library)
        monkeypatch.setattr("passo.simulator.board.firmware_library", lambda: library)
        chosen = machine.board.model_copy(update={"firmware": "passo"})
        machine = machine.model_copy(update={"board": chosen})
        return simulated_board(machine, board_description(machine))

    @pytest.fixture
    def line(
        self, board: SimulatedBoard, machine: MachineConfig, clock: SharedClock
    ) -> Iterator[SharedLine]:
        line = SharedLine(clock, board.device, machine.board.clock_hz)
        yield line
        line.close()

    @pytest.fixture
    def kalico(self, hosts, tmp_path, clock, line, configuration) -> Iterator[Kalico]:
        with Kalico(hosts, tmp_path, line.path, configuration, clock) as kalico:
            yield kalico

    def test_kalico_uses_drivers_and_thermocouple(self, board, line, clock, kalico):
        chips = board.drivers

        def registers() -> dict[str, dict[int, int]]:
            numbers = (r.IHOLD_IRUN, r.CHOPCONF, r.GCONF, r.IFCNT, r.GLOBALSCALER)
            return {name: {n: chip.read(n) for n in numbers} for name, chip in chips.items()}

        kalico.tell("G92 E0")
        kalico.tell("SET_TMC_CURRENT STEPPER=stepper_y CURRENT=0.5")
        found = line.look(registers)
        assert line.look(lambda: board.device.fault) == ""
        expected = {"x": 0.8, "y": 0.5, "z": 0.6, "e": 1.2}
        for name, numbers in found.items():
            chip: ChipName = "TMC5160" if name == "e" else "TMC2209"
            irun = r.fields(chip, r.IHOLD_IRUN, numbers[r.IHOLD_IRUN])["irun"]
            chopper = r.fields(chip, r.CHOPCONF, numbers[r.CHOPCONF])
            assert chopper["mres"] == 4
            if name == "e":
                ampere = (irun + 1) / 32 * numbers[r.GLOBALSCALER] / 256 * 0.325 / 0.075 / 2**0.5
            else:
                volts = 0.18 if chopper["vsense"] else 0.32
                ampere = (irun + 1) / 32 * volts / 0.13 / 2**0.5
                assert numbers[r.IFCNT] >= 5
            assert ampere == pytest.approx(expected[name], rel=0.05)
        assert "IOIN" in kalico.tell("DUMP_TMC STEPPER=stepper_z")
        clock.pass_s(1)  # until it has asked
        assert re.search(r"T0:25\.\d /0\.0", kalico.tell("M105"))


class TestAccelerometer:
    """Kalico measures the simulated head with its own analysis, through the firmware and the bus
    that the firmware makes."""

    @pytest.fixture(params=[SPI, I2C], ids=["spi", "i2c"])
    def wiring(self, request: pytest.FixtureRequest) -> tuple[str, str]:
        return request.param

    @pytest.fixture
    def machine(self, wiring: tuple[str, str]) -> MachineConfig:
        board = ('base = "ramps"', 'base = "ramps"\nfirmware = "passo"')
        return edited("i3", board, more=wiring[0] + MASS)

    @pytest.fixture
    def configuration(self, wiring: tuple[str, str]) -> str:
        return (HERE / "kalico.cfg").read_text(encoding="utf-8") + TESTER.rstrip() + wiring[1]

    @pytest.fixture
    def line(
        self,
        tmp_path: Path,
        machine: MachineConfig,
        clock: SharedClock,
        monkeypatch: pytest.MonkeyPatch,
    ) -> Iterator[SharedLine]:
        library = library_for_older_hosts()
        monkeypatch.setattr(simulated, "firmware_library", lambda: library)
        monkeypatch.setattr("passo.simulator.board.firmware_library", lambda: library)
        printer = simulated_machine(machine, board_descriptions(machine))
        line = SharedLine(clock, printer.device, machine.board.clock_hz)
        yield line
        line.close()

    def test_kalico_finds_the_frequency_of_the_head(
        self, hosts, tmp_path, clock, line, configuration
    ) -> None:
        with Kalico(hosts, tmp_path, line.path, configuration, clock) as kalico:
            (found,) = re.findall(r"\(x, y, z\): (.*)", kalico.tell("ACCELEROMETER_QUERY"))
            values = [float(value) for value in found.split(",")]
            assert values == pytest.approx([0, 0, 9806.65], abs=300)
            kalico.tell("G28")
            line = "SHAPER_CALIBRATE AXIS=X FREQ_START=40 FREQ_END=56 HZ_PER_SEC=2 NAME=passo"
            answer = kalico.tell(line)
        (hz,) = re.findall(r"Recommended shaper_type_x = mzv, shaper_freq_x = ([\d.]+)", answer)
        assert float(hz) == pytest.approx(48, abs=1)
        Path("/tmp/calibration_data_x_passo.csv").unlink()  # where Kalico always writes it
