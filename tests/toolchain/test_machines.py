"""Images for the boards of all shipped machines."""

import json
from math import ceil
from pathlib import Path

import pytest
from tests.config.test_pins import KLIPPER

from passo import config
from passo.cli.main import main
from passo.config.machine import MachineConfig
from passo.errors import FirmwareError
from passo.toolchain.avr import PULSE_TICKS
from passo.toolchain.targets import Target, target

_ANY_ARM = "one image a board"


def _aim(machine: str, folder: Path) -> Target:
    path = folder / f"{machine}.toml"
    path.write_text(config.shipped_text(machine), encoding="utf-8")
    return target(str(path))


def _alike(aim: Target) -> tuple[object, ...]:
    """What makes one image another: chip, clock, console and motors. On other chips than AVR the
    machine changes nothing, and test_build.py builds each board: one of them all is enough."""
    board = aim.board
    if aim.chip.core != "avr":
        return (_ANY_ARM,)
    motors = [
        (m.step_pin, m.direction_pin, m.compare)
        for m in aim.motors
        if ceil(m.pulse_us * board.clock_hz / 1e6) <= PULSE_TICKS  # others have no units
    ]
    return board.mcu, board.clock_hz, str(board.console), len(aim.motors), *motors


def _motors(machine: MachineConfig) -> list[tuple[str, str]]:
    """Pins of the chip, without marks: step and direction of each motor."""
    pins: list[tuple[str, str]] = []
    for name, stepper in machine.steppers.items():
        driver = machine.socket(name)
        words = (
            (driver.step, driver.direction) if driver else (stepper.step_pin, stepper.direction_pin)
        )
        step, direction = (machine.pin(word or "").lstrip("!^~") for word in words)
        pins.append((step, direction))
    return pins


def test_every_shipped_machine_has_an_image(tmp_path: Path) -> None:
    """One of each kind is built, and another of the largest."""
    kinds: dict[tuple[object, ...], list[str]] = {}
    for name in config.shipped_machines():
        machine = config.load(name)
        if machine.board.is_klippers:
            with pytest.raises(FirmwareError, match="it runs Klipper's own firmware"):
                _aim(name, tmp_path)
            continue
        aim = _aim(name, tmp_path)
        assert aim.board == machine.board and aim.name == name
        assert [(m.step_pin, m.direction_pin) for m in aim.motors] == _motors(machine)
        kinds.setdefault(_alike(aim), []).append(name)
    assert 1 < len(kinds) < len(config.shipped_machines())
    hashes = [_built(tmp_path, first) for first, *_ in kinds.values()]
    assert len(set(hashes)) == len(kinds)
    alike = max((names for kind, names in kinds.items() if kind != (_ANY_ARM,)), key=len)
    assert _built(tmp_path, alike[-1]) == _built(tmp_path, alike[0])


def _built(folder: Path, machine: str) -> str:
    """The hash of a machine's image."""
    path = str(folder / f"{machine}.toml")
    assert main(["firmware", "build", path, "--output", str(folder)]) == 0
    about = json.loads((folder / f"{machine}.json").read_text())
    board = config.load(machine).board
    assert (about["target"], about["board"], about["mcu"]) == (machine, board.name, board.mcu)
    assert about["dictionary"]["config"]["CLOCK_FREQ"] == board.clock_hz
    assert about["flash_bytes"] < about["flash_size"] and about["ram_bytes"] < about["ram_size"]
    return about["sha256"]


def test_a_machine_whose_board_has_firmware_of_its_own_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(KLIPPER.replace('dictionary = "board.dict"', "clock_hz = 72_000_000"))
    assert main(["firmware", "build", str(path), "--output", str(tmp_path)]) == 2
    assert "no firmware of Passo for i3: it runs Klipper's own firmware" in capsys.readouterr().err
    assert [*tmp_path.iterdir()] == [path]
