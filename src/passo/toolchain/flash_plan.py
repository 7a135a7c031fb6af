"""Plans the steps that flash an image onto a board. This module does not access the board."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path

from passo.config.board import Board, Flash
from passo.errors import FirmwareError, Problem
from passo.toolchain.targets import KLIPPERS, no_firmware

SUFFIXES: dict[str, tuple[str, ...]] = {
    "avrdude": (".hex",),
    "bossac": (".bin",),
    "openocd": (".elf", ".bin"),
    "teensy_loader_cli": (".hex",),
    "uf2": (".uf2",),
}
_NEEDS_PORT = ("avrdude", "bossac", "uf2")


@dataclass(frozen=True, slots=True)
class Hands:
    """An action of the user before the next step."""

    text: str

    def __str__(self) -> str:
        """The step as a sentence."""
        return self.text


@dataclass(frozen=True, slots=True)
class Touch:
    """Opening the port at 1200 baud and closing it starts the boot loader of the chip."""

    port: str

    def __str__(self) -> str:
        """The step as a sentence."""
        return f"open {self.port} at 1200 baud for a moment"


@dataclass(frozen=True, slots=True)
class Run:
    """A program that writes the image."""

    words: tuple[str, ...]

    def __str__(self) -> str:
        """The step as a sentence."""
        return shlex.join(self.words)


@dataclass(frozen=True, slots=True)
class Copy:
    """Copying the image onto the drive that the board's boot loader shows."""

    image: Path
    folder: Path

    def __str__(self) -> str:
        """The step as a sentence."""
        return f"copy {self.image} to {self.folder}"


Step = Hands | Touch | Run | Copy


def plan(name: str, board: Board, port: str | None, image: Path) -> list[Step]:
    """The steps that flash `image` onto a board at `port`: a serial port, or for `uf2` the folder
    where the board's drive is mounted. Raises FirmwareError if the board cannot be flashed, or if
    the port is missing."""
    flash = board.flash
    if flash is None or board.chip is None:
        raise no_firmware(name, KLIPPERS if board.chip is None else "it has no way to be flashed")
    if not port and flash.method in _NEEDS_PORT:
        expected = "the folder of its drive" if flash.method == "uf2" else "a serial port"
        values = {"axis": name, "limit": expected}
        raise FirmwareError([Problem("firmware.no-port", values=values)])
    steps: list[Step] = [Hands(text) for text in flash.before]
    if flash.touch and port:
        steps.append(Touch(port))
    if flash.method == "uf2" and port:
        steps.append(Copy(image, Path(port)))
    else:
        native = board.incomplete == "usb"
        steps.append(Run(_words(flash, board.chip.flash_start, port or "", image, native=native)))
    return [*steps, *(Hands(text) for text in flash.after)]


def _words(flash: Flash, start: int, port: str, image: Path, *, native: bool) -> tuple[str, ...]:
    """The program's command line; `native` means that the chip's own USB is at the port."""
    match flash.method:
        case "avrdude":
            # -D: no chip erase, which would also delete the settings of the boot loader.
            tool = ("avrdude", "-p", flash.part, "-c", flash.programmer, "-b", str(flash.baud))
            return (*tool, "-P", port, "-D", "-U", f"flash:w:{image}:i")
        case "bossac":
            # Erase, write, verify, start from flash. A programming port is a bridge to the chip's
            # UART, although it looks like USB: hence -Ufalse, in one word, because only bossac 1.6
            # reads a separate word as the argument of -U. On such a port bossac can reset the
            # board: -R. On the USB port of the chip itself, bossac detects USB without an option,
            # and the user resets the board afterwards.
            tool = ("bossac", "-p", port.removeprefix("/dev/"))
            work = ("-e", "-w", "-v", "-b", str(image))
            return (*tool, *work) if native else (*tool, "-Ufalse", *work, "-R")
        case "openocd":
            at = "" if image.suffix == ".elf" else f" 0x{start:08x}"
            program = f"program {{{image}}}{at} verify reset exit"
            files = ("-f", "interface/stlink.cfg", "-f", f"target/{flash.target}.cfg")
            return ("openocd", *files, "-c", program)
        case _:
            return ("teensy_loader_cli", f"--mcu={flash.part}", "-w", "-v", str(image))
