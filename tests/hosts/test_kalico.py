"""Kalico, a host of another house, drives a board that runs the firmware: over a pty, in real time.
Its words are those of older hosts, so the firmware is built for them."""

from __future__ import annotations

import os
import re
import select
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.firmware.library import library_for_older_hosts
from tests.hosts.cable import Cable
from tests.printer.driver_machine import machine_text

from passo import config
from passo.board.trinamic import registers as r
from passo.config.machine import MachineConfig
from passo.simulator import SimulatedBoard
from passo.simulator import dictionary as simulated

HERE = Path(__file__).parent
PATIENCE_S = 40
PRINT = """\
G1 X50 Y40 Z2 F9000
G92 E0
G1 X60 Y60 E2 F1800
G1 X20 E5
G1 Y50.0125 E5.5
G1 X45.6 Y57.3 Z2.4 F6000
"""
STEPS = {"x": -352, "y": 1384, "z": 160, "e": 525}  # of all but the first line

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


@pytest.fixture
def library(tmp_path: Path) -> Path:
    return library_for_older_hosts(tmp_path)


@pytest.fixture
def machine() -> MachineConfig:
    """The shipped i3."""
    return config.load("i3")


@pytest.fixture
def cable(
    library: Path, machine: MachineConfig, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Cable]:
    """The machine's board on a serial line."""
    monkeypatch.setattr(simulated, "firmware_library", lambda: library)
    monkeypatch.setattr("passo.simulator.board.firmware_library", lambda: library)
    chosen = machine.board.model_copy(update={"firmware": "passo"})
    machine = machine.model_copy(update={"board": chosen})
    cable = Cable(machine)
    yield cable
    cable.close()


class Kalico:
    """A running Kalico, spoken to over its own pty."""

    def __init__(self, hosts: Path, folder: Path, device: str, configuration: str) -> None:
        text = configuration.format(serial=device)
        (folder / "printer.cfg").write_text(text, encoding="utf-8")
        self.log = folder / "kalico.log"
        words = [hosts / "python", "-m", "klippy", "printer.cfg", "-l", self.log, "-I", "printer"]
        self.process = subprocess.Popen(
            list(map(str, words)), cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT
        )
        self._heard = ""
        self._fd = -1
        self._pty = folder / "printer"

    def wait(self) -> None:
        """Until it is ready."""
        self._until(self._pty.is_symlink, "its pty")
        self._fd = os.open(self._pty, os.O_RDWR | os.O_NOCTTY)
        self._until(lambda: "!!" not in self._answer("STATUS"), "being ready")

    def _until(self, condition, what: str) -> None:
        end = time.monotonic() + PATIENCE_S
        while not condition():
            assert self.process.poll() is None and time.monotonic() < end, (what, self.said())
            time.sleep(0.1)

    def tell(self, line: str) -> str:
        """Sends a line; returns what came until it was acknowledged, which is no error."""
        answer = self._answer(line)
        assert "!!" not in answer, (answer, self.said())
        return answer

    def _answer(self, line: str) -> str:
        os.write(self._fd, line.encode() + b"\n")
        end = time.monotonic() + PATIENCE_S
        while not (ok := re.search(r"^ok.*\n", self._heard, re.MULTILINE)):
            assert time.monotonic() < end, (line, self._heard, self.said())
            if select.select([self._fd], [], [], 0.1)[0]:
                self._heard += os.read(self._fd, 4096).decode()
        answer, self._heard = self._heard[: ok.end()], self._heard[ok.end() :]
        return answer

    def said(self) -> str:
        return self.log.read_text(encoding="utf-8", errors="replace")[-2000:]

    def close(self) -> None:
        self.process.terminate()
        self.process.wait()
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1


@pytest.fixture
def configuration() -> str:
    """What Kalico is told of the machine."""
    return (HERE / "kalico.cfg").read_text(encoding="utf-8")


@pytest.fixture
def kalico(hosts: Path, cable: Cable, tmp_path: Path, configuration: str) -> Iterator[Kalico]:
    host = Kalico(hosts, tmp_path, cable.path, configuration)
    try:
        host.wait()
        yield host
    finally:
        host.close()


def net_steps(board: SimulatedBoard) -> dict[str, int]:
    return {s.name: board.net_steps(s.name) for s in board.board.steppers}


def test_it_homes_prints_and_heats(cable, kalico):
    board = cable.board
    kalico.tell("G28")
    first, *rest = PRINT.splitlines()
    kalico.tell(first)
    kalico.tell("M400")
    before = cable.look(lambda: net_steps(board))
    for axis, at in (("x", 50), ("y", 40), ("z", 2)):
        assert cable.look(lambda axis=axis: board.position(axis)) == pytest.approx(at, abs=0.02)
    for line in rest:
        kalico.tell(line)
    kalico.tell("M400")
    after = cable.look(lambda: net_steps(board))
    assert {axis: after[axis] - before[axis] for axis in after} == STEPS
    assert cable.look(lambda: board.device.fault) == ""
    assert re.search(r"T0:2[45]\.\d /0\.0", kalico.tell("M105"))
    kalico.tell("M104 S200")
    kalico.tell("G4 P4000")
    assert cable.look(lambda: board.temperature("hotend")) > 30
    kalico.close()  # nobody renews the heater any more
    end = time.monotonic() + PATIENCE_S
    while cable.look(lambda: board.device.fault) == "" and time.monotonic() < end:
        time.sleep(0.1)
    cable.cut()
    assert board.device.fault == "Missed scheduling of next digital out event"
    assert board.output_value("hotend") == 0


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

    def test_it_sets_drivers_up_and_asks_a_thermocouple(self, cable, kalico):
        chips = cable.board.drivers

        def registers() -> dict[str, dict[int, int]]:
            numbers = (r.IHOLD_IRUN, r.CHOPCONF, r.GCONF, r.IFCNT, r.GLOBALSCALER)
            return {name: {n: chip.read(n) for n in numbers} for name, chip in chips.items()}

        kalico.tell("G92 E0")
        kalico.tell("SET_TMC_CURRENT STEPPER=stepper_y CURRENT=0.5")
        found = cable.look(registers)
        assert cable.look(lambda: cable.board.device.fault) == ""
        expected = {"x": 0.8, "y": 0.5, "z": 0.6, "e": 1.2}
        for name, numbers in found.items():
            chip = r.CHIPS["TMC5160" if name == "e" else "TMC2209"]
            irun = chip.unpack(r.IHOLD_IRUN, numbers[r.IHOLD_IRUN])["irun"]
            chopper = chip.unpack(r.CHOPCONF, numbers[r.CHOPCONF])
            assert chopper["mres"] == 4
            if name == "e":
                ampere = (irun + 1) / 32 * numbers[r.GLOBALSCALER] / 256 * 0.325 / 0.075 / 2**0.5
            else:
                volts = 0.18 if chopper["vsense"] else 0.32
                ampere = (irun + 1) / 32 * volts / 0.13 / 2**0.5
                assert numbers[r.IFCNT] >= 5
            assert ampere == pytest.approx(expected[name], rel=0.05)
        assert "IOIN" in kalico.tell("DUMP_TMC STEPPER=stepper_z")
        assert re.search(r"T0:25\.\d /0\.0", kalico.tell("M105"))
