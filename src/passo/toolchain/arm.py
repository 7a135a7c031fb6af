"""Images for Cortex-M chips: the sources, the flags of both compilers, the image out of the ELF."""

from __future__ import annotations

import importlib.util
import re
import shutil
import struct
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from passo.config.chips import Chip
from passo.toolchain.avr import FirmwareError
from passo.toolchain.declarations import Constant, gather
from passo.toolchain.image import Image
from passo.toolchain.tables import dictionary, write_tables

# Chips whose folder is in firmware/hal/arm.
CHIPS = ("sam3x8e",)
# A stack this deep must fit beside the static data.
STACK = 4096
_RECEIVE_WINDOW = 192
_CPU = {"cortex-m0plus": "cortex-m0+", "cortex-m3": "cortex-m3", "cortex-m4": "cortex-m4"}
_LOAD = 1
_COMPILE = (
    *("-std=gnu11", "-Os", "-Wall", "-Wextra", "-ffreestanding", "-fno-builtin"),
    *("-fno-strict-aliasing", "-ffunction-sections", "-fdata-sections", "-fshort-enums"),
)


@dataclass(frozen=True, slots=True)
class ArmBoard:
    """What an image is built for; `console` are the console's pins."""

    chip: Chip
    clock_hz: int
    baud: int
    console: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Segment:
    """A part of an ELF file that is loaded: where it lies in flash, where it runs, its bytes, and
    how many there are with those that begin as 0."""

    load: int
    run: int
    content: bytes
    size: int


def compiler() -> list[str] | None:
    """The command of a compiler: the system's arm-none-eabi-gcc, else that of the package ziglang;
    None if there is neither."""
    if shutil.which("arm-none-eabi-gcc"):
        return ["arm-none-eabi-gcc"]
    if importlib.util.find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "cc"]
    return None


def board_header(board: ArmBoard) -> str:
    """board.h for firmware/hal/arm."""
    return "\n".join(
        [
            "// Made by the build.",
            "#pragma once",
            f"#define BOARD_CLOCK_HZ {board.clock_hz}UL",
            f"#define BOARD_BAUD {board.baud}UL",
            "",
        ]
    )


def memory(chip: Chip) -> str:
    """What firmware/hal/arm/link.ld needs before it."""
    return "\n".join(
        [
            "MEMORY {",
            f"  FLASH (rx) : ORIGIN = 0x{chip.flash_start:08x}, LENGTH = {chip.flash_bytes}",
            f"  RAM (rwx) : ORIGIN = 0x{chip.ram_start:08x}, LENGTH = {chip.ram_bytes}",
            "}",
            "",
        ]
    )


def sources(firmware: Path, chip: Chip) -> list[Path]:
    """The sources of an image, below the folder `firmware`."""
    layer = firmware / "hal" / "arm"
    found = [
        *firmware.glob("core/*.c"),
        *firmware.glob("hal/common/*.c"),
        *layer.glob("*.c"),
        *(layer / chip.key).glob("*.c"),
        firmware / "hal" / "plain" / "string.c",
    ]
    return sorted(found)


def flags(command: list[str], chip: Chip) -> list[str]:
    """How a compiler compiles and links for a chip."""
    cpu = _CPU[chip.core]
    common = [*_COMPILE, "-nostartfiles", "-nostdlib"]
    if command[0] == "arm-none-eabi-gcc":
        # A loop in memcpy() must not become a call of memcpy().
        common.append("-fno-tree-loop-distribute-patterns")
        return ["-mthumb", f"-mcpu={cpu}", *common, "-Wl,--gc-sections", "-lgcc"]
    target = ["-target", "thumb-freestanding-eabi", f"-mcpu={cpu.replace('-', '_')}"]
    common.remove("-nostdlib")  # the compiler's own support library comes with the standard ones
    return [*target, *common, "-Wl,--gc-sections"]


def enumerations(chip: Chip) -> dict[str, dict[str, int | tuple[int, int]]]:
    """The names of the pins: 32 a port, counted from port A."""
    counts: dict[str, int] = {}
    for pin in chip.pins:
        match = re.fullmatch(r"P([A-Z])(\d+)", pin)
        if match is None:
            raise FirmwareError(f"{pin} is no pin of {chip.name}")
        counts[match[1]] = max(counts.get(match[1], 0), int(match[2]) + 1)
    return {"pin": {f"P{p}0": ((ord(p) - ord("A")) * 32, n) for p, n in counts.items()}}


def constants(board: ArmBoard) -> dict[str, Constant]:
    """What the host must know of the chip."""
    return {
        "CLOCK_FREQ": board.clock_hz,
        "MCU": board.chip.key,
        "SERIAL_BAUD": board.baud,
        "RECEIVE_WINDOW": _RECEIVE_WINDOW,
        "ADC_MAX": 2**board.chip.adc_bits - 1,
        "PWM_MAX": 255,
        "RESERVE_PINS_serial": ",".join(board.console),
    }


def build(
    board: ArmBoard, firmware: Path, output: Path, command: list[str], version: str = ""
) -> Image:
    """Builds an image with the compiler `command` into the folder `output`. Raises FirmwareError if
    the compiler fails, or if the image does not fit."""
    output.mkdir(parents=True, exist_ok=True)
    chip, layer = board.chip, firmware / "hal" / "arm"
    code = sources(firmware, chip)
    found = gather(code)
    content = dictionary(
        found, version=version, constants=constants(board), enumerations=enumerations(chip)
    )
    tables = write_tables(found, content, output)
    (output / "board.h").write_text(board_header(board), encoding="utf-8")
    script = memory(chip) + (layer / "link.ld").read_text(encoding="utf-8")
    (output / "image.ld").write_text(script, encoding="utf-8")
    elf, image = output / "passo.elf", output / "passo.bin"
    folders = [output, *(firmware / f for f in ("core", "hal", "hal/common")), layer]
    include = [f"-I{folder}" for folder in (*folders, layer / chip.key)]
    words = [*command, *include, *map(str, (*code, *tables)), *flags(command, chip)]
    words += [f"-Wl,-T,{output / 'image.ld'}"]
    done = subprocess.run([*words, "-o", str(elf)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise FirmwareError(done.stderr.strip())
    parts = segments(elf.read_bytes())
    data = flash_content(parts, chip)
    image.write_bytes(data)
    in_ram = (p for p in parts if chip.ram_start <= p.run < chip.ram_start + chip.ram_bytes)
    ram = sum(p.size for p in in_ram)
    if len(data) > chip.flash_bytes or ram > chip.ram_bytes - STACK:
        raise FirmwareError(f"{len(data)} bytes of flash, {ram} of RAM: more than {chip.name} has")
    return Image(elf, image, len(data), ram, content)


def segments(elf: bytes) -> list[Segment]:
    """What a 32-bit little-endian ELF file loads. Raises FirmwareError if it is none."""
    if elf[:6] != b"\x7fELF\x01\x01":
        raise FirmwareError("the compiler made no ELF file")
    (offset,) = struct.unpack_from("<I", elf, 28)
    size, count = struct.unpack_from("<HH", elf, 42)
    parts: list[Segment] = []
    for at in range(offset, offset + size * count, size):
        kind, begin, run, load, in_file, in_memory = struct.unpack_from("<6I", elf, at)
        if kind == _LOAD and in_memory:
            parts.append(Segment(load, run, elf[begin : begin + in_file], in_memory))
    return parts


def flash_content(parts: list[Segment], chip: Chip) -> bytes:
    """The content of the flash from its start on. Raises FirmwareError if something lies before."""
    data = bytearray()
    for part in sorted(parts, key=lambda part: part.load):
        if not part.content:
            continue
        at = part.load - chip.flash_start
        if at < len(data):
            raise FirmwareError(f"0x{part.load:08x} is no place in the flash of {chip.name}")
        data += b"\xff" * (at - len(data)) + part.content
    return bytes(data)
