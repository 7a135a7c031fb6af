"""Builds the firmware of a board: an image for the flashing tool, and a JSON file about it."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import tempfile
from pathlib import Path

import passo
from passo import _core
from passo.errors import FirmwareError, Problem
from passo.toolchain import avr
from passo.toolchain.images import About, write_about
from passo.toolchain.tables import compress
from passo.toolchain.targets import LAYERS, Target, no_firmware


def firmware_folder() -> Path:
    """The firmware's sources: those of a checkout, or those that are installed."""
    checkout = Path(passo.__file__).parents[2] / "firmware"
    return checkout if checkout.is_dir() else Path(_core.__file__).with_name("firmware")


def build(target: Target, output: Path) -> tuple[Path, About]:
    """Builds the image of a target into the folder `output`. Returns its path, and what the JSON
    file beside it says.

    The same sources, compiler and target make the same image. Raises FirmwareError if there is no
    firmware for that chip yet, if the compiler is missing, or if the build fails.
    """
    chip = target.chip
    if chip.core not in LAYERS:
        raise no_firmware(target.name, f"that for the {chip.name} is not written yet")
    if shutil.which("avr-gcc") is None:
        raise _problem("firmware.tool", target, "avr-gcc (Debian: gcc-avr, avr-libc)")
    try:
        output.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory() as folder:
            board, firmware = _avr_board(target), firmware_folder()
            made = avr.build(board, firmware, Path(folder), _version(board, firmware))
            image = output / f"{target.name}.hex"
            shutil.copyfile(made.hex, image)
    except avr.FirmwareError as error:
        raise _problem("firmware.build", target, str(error)) from None
    except OSError as error:
        values = {"value": error.strerror or str(error)}
        raise FirmwareError([Problem("output.unwritable", str(output), None, values)]) from None
    about = About(
        target=target.name,
        board=target.board.name,
        mcu=target.board.mcu,
        image=image.name,
        sha256=hashlib.sha256(image.read_bytes()).hexdigest(),
        flash_bytes=made.flash,
        flash_size=chip.flash_bytes,
        ram_bytes=made.ram,
        ram_size=chip.ram_bytes,
        version=made.dictionary["version"],
        compiler=_compiler("avr-gcc"),
        dictionary_sha256=hashlib.sha256(compress(made.dictionary)).hexdigest(),
        dictionary=made.dictionary,
    )
    write_about(about, image)
    return image, about


def _avr_board(target: Target) -> avr.AvrBoard:
    console = target.board.console
    if console is None:
        raise no_firmware(target.name, "the board file names no console")
    motors = (avr.Motor(m.step_pin, m.direction_pin, m.compare) for m in target.motors)
    return avr.AvrBoard(target.board.mcu, tuple(motors), target.board.clock_hz, console.baud)


def _version(board: avr.AvrBoard, firmware: Path) -> str:
    """Passo's version and a digest of all that the image is made from, so that a board tells which
    image it runs."""
    digest = hashlib.sha256(avr.board_header(board).encode())
    for path in sorted(firmware.rglob("*.[chS]")):
        digest.update(path.read_bytes())
    return f"{passo.__version__}-{digest.hexdigest()[:12]}"


def _compiler(command: str) -> str:
    """The compiler's name and version, as it says itself."""
    done = subprocess.run([command, "--version"], capture_output=True, text=True, check=False)
    return done.stdout.partition("\n")[0]


def _problem(code: str, target: Target, value: str) -> FirmwareError:
    return FirmwareError([Problem(code, values={"axis": target.name, "value": value})])
