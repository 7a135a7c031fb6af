"""The targets of firmware builds: shipped boards, and machines with motors on other pins."""

from __future__ import annotations

from dataclasses import dataclass

from passo import config
from passo.config.board import Board
from passo.config.chips import Chip
from passo.config.pin_names import MAIN, placed
from passo.errors import FirmwareError, Problem

# For a board whose microcontroller Passo does not support.
KLIPPERS = "it runs Klipper's own firmware"


@dataclass(frozen=True, slots=True)
class Motor:
    """A motor with its pins of the microcontroller; `compare` is its compare unit, if given, and
    `pulse_us` the pulse that its driver needs, if known."""

    name: str
    step_pin: str
    direction_pin: str
    compare: str | None = None
    pulse_us: float = 0.0


@dataclass(frozen=True, slots=True)
class Target:
    """The board of an image; `name` is that of the board or of the machine."""

    name: str
    board: Board
    motors: tuple[Motor, ...]

    @property
    def chip(self) -> Chip:
        """The data of the microcontroller. Raises FirmwareError if Passo does not support it."""
        chip = self.board.chip
        if chip is None:
            raise no_firmware(self.name, KLIPPERS)
        return chip


def target(name: str) -> Target:
    """The shipped board of that name, or the board of the machine file of that path; with `:NAME`
    after it, the further board of that name.

    Raises FirmwareError if there is no such board, or if the board of the machine file runs
    Klipper's firmware, and ConfigError for a machine file with errors.
    """
    path, colon, board = name.partition(".toml:")
    if colon:
        return machine_target(config.load(f"{path}.toml"), board)
    if config.machine_path(name) is not None:
        return machine_target(config.load(name), MAIN)
    return board_target(name)


def board_target(name: str) -> Target:
    """A shipped board. Raises FirmwareError if there is none."""
    if name not in config.shipped_boards():
        raise FirmwareError([Problem("firmware.board", values={"value": name})])
    board = config.load_board(name)
    motors = (
        Motor(key, bare(socket.step), bare(socket.direction), socket.compare)
        for key, socket in board.sockets.items()
    )
    return Target(name, board, tuple(motors))


def machine_target(machine: config.MachineConfig, board_name: str) -> Target:
    """A board of a machine. Raises FirmwareError if there is none, or if it runs Klipper's
    firmware."""
    board = machine.all_boards.get(board_name)
    if board is None:
        raise FirmwareError([Problem("firmware.board", values={"value": board_name})])
    if board.is_klippers:
        raise no_firmware(machine.name, KLIPPERS)
    motors: list[Motor] = []
    for name, stepper in machine.steppers.items():
        if machine.board_of_stepper(name) != board_name:
            continue
        socket = machine.socket(name)
        step = placed(stepper.step_pin or (socket.step if socket else ""))[1]
        direction = placed(stepper.direction_pin or (socket.direction if socket else ""))[1]
        compare = socket.compare if socket else None
        pins = bare(board.pin(step)), bare(board.pin(direction))
        motors.append(Motor(name, *pins, compare, stepper.shortest_pulse_us))
    return Target(f"{machine.name}-{board_name}" if board_name else machine.name, board, (*motors,))


def state(board: Board) -> str:
    """How far Passo's firmware supports a board: `ready`; `incomplete: usb` if the firmware cannot
    use the board's only connector; or that only another firmware runs on the board."""
    if board.chip is None:
        return "runs Klipper's"
    return f"incomplete: {board.incomplete}" if board.incomplete else "ready"


def no_firmware(name: str, why: str) -> FirmwareError:
    """The error that there is no image for this board."""
    return FirmwareError([Problem("firmware.none", values={"axis": name, "value": why})])


def bare(pin: str) -> str:
    """The pin's name without `!`, `^` and `~`."""
    return pin.lstrip("!^~")
