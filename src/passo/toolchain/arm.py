"""Images for Cortex-M chips: the sources, the flags of both compilers, the image from the ELF
file."""

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
from passo.toolchain.declarations import Constant
from passo.toolchain.formats import with_boot_sum
from passo.toolchain.image import Image
from passo.toolchain.sources import core_sources
from passo.toolchain.tables import write_board

# The folders of each chip in firmware/hal/arm: the chip's own, and that of its family.
CHIPS = {
    "sam3x8e": ("sam3x8e", "sam3"),
    "sam3u4e": ("sam3u4e", "sam3"),
    "mk20dx128": ("mk20dx128", "mk20"),
    "mk20dx256": ("mk20dx256", "mk20"),
    "rp2040": ("rp2040",),
    "stm32f407": ("stm32f4",),
    "stm32f429": ("stm32f4",),
}
# Chips with external, slow flash: a boot stage, which their ROM checks, copies the code to RAM.
STAGED = ("rp2040",)
# RAM must have space for a stack of this size in addition to the static data.
STACK = 4096
_RECEIVE_WINDOW = 192
_LOAD = 1
_PIN = re.compile(r"(?:P|PT)([A-Z])(\d+)|gpio(\d+)")
_COMPILE = (
    *("-std=gnu11", "-Os", "-Wall", "-Wextra", "-ffreestanding", "-fno-builtin"),
    *("-fno-strict-aliasing", "-ffunction-sections", "-fdata-sections", "-fshort-enums"),
)


@dataclass(frozen=True, slots=True)
class ArmBoard:
    """The board for which an image is built. `console` names the receive and the transmit pin of
    `uart`. With `older_hosts`, the image uses the older protocol version."""

    chip: Chip
    clock_hz: int
    uart: str
    baud: int
    console: tuple[str, ...]
    older_hosts: bool = False


@dataclass(frozen=True, slots=True)
class Segment:
    """A part of an ELF file that is loaded: its flash address, its address at run time, its bytes,
    and its size including the bytes that start as 0."""

    load: int
    run: int
    content: bytes
    size: int


def compiler() -> list[str] | None:
    """The command of a compiler: arm-none-eabi-gcc of the system, else the compiler of the package
    ziglang; None if there is neither."""
    if shutil.which("arm-none-eabi-gcc"):
        return ["arm-none-eabi-gcc"]
    if importlib.util.find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "cc"]
    return None


def pin_number(chip: Chip, pin: str) -> int:
    """A pin's number: 32 for each port, counted from port A. Raises FirmwareError if it is
    invalid."""
    match = _PIN.fullmatch(pin)
    if match is None or pin not in chip.pins:
        raise FirmwareError(f"{pin} is not a pin of {chip.name}")
    port, n, alone = match.groups()
    return int(alone) if port is None else (ord(port) - ord("A")) * 32 + int(n)


def board_header(board: ArmBoard) -> str:
    """board.h for firmware/hal/arm: the differences between boards, and the chip's pins."""
    chip = board.chip
    receive, send = (pin_number(chip, pin) for pin in board.console)
    masks: dict[int, int] = {}
    for pin in chip.pins:
        port, bit = divmod(pin_number(chip, pin), 32)
        masks[port] = masks.get(port, 0) | (pin not in board.console) << bit
    usable = (f"0x{masks.get(i, 0):08x}" for i in range(max(masks) + 1))
    analog = (f"X({pin_number(chip, pin)}, {channel})" for pin, channel in chip.adc.items())
    pulses = (
        f"X({pin_number(chip, pin)}, {way.timer}, {way.channel})"
        for pin, ways in chip.pwm.items()
        for way in ways
        if not chip.timers[way.timer].firmware
    )
    return "\n".join(
        [
            "// Made by the build.",
            "#pragma once",
            f"#define BOARD_CLOCK_HZ {board.clock_hz}UL",
            f"#define BOARD_UART_{board.uart} 1",
            f"#define BOARD_BAUD {board.baud}UL",
            f"#define BOARD_RECEIVE {receive}",
            f"#define BOARD_SEND {send}",
            f"#define CHIP_PINS {', '.join(usable)}",
            f"#define CHIP_ANALOG(X) {' '.join(analog)}",
            f"#define CHIP_PULSES(X) {' '.join(pulses)}",
            "",
        ]
    )


def memory(chip: Chip) -> str:
    """The memory layout that firmware/hal/arm/link.ld needs before it."""
    return "\n".join(
        [
            "MEMORY {",
            f"  FLASH (rx) : ORIGIN = 0x{chip.flash_start:08x}, LENGTH = {chip.flash_bytes}",
            f"  RAM (rwx) : ORIGIN = 0x{chip.ram_start:08x}, LENGTH = {chip.ram_bytes}",
            "}",
            f'REGION_ALIAS("CODE", {"RAM" if chip.key in STAGED else "FLASH"})',
            "",
        ]
    )


def sources(board: ArmBoard, firmware: Path) -> list[Path]:
    """The sources of an image, below the folder `firmware`."""
    found = [
        *core_sources(firmware, older_hosts=board.older_hosts),
        *firmware.glob("hal/common/*.c"),
        *(source for folder in _layer(firmware, board.chip) for source in folder.glob("*.[cS]")),
        firmware / "hal" / "plain" / "string.c",
    ]
    return sorted(found)


def _layer(firmware: Path, chip: Chip) -> list[Path]:
    """The folders of the chip's hardware layer, the general one last."""
    layer = firmware / "hal" / "arm"
    return [*(layer / name for name in CHIPS[chip.key]), layer]


def flags(command: list[str], chip: Chip) -> list[str]:
    """The flags with which a compiler compiles and links for a chip."""
    common = [*_COMPILE, "-nostartfiles", "-nostdlib"]
    if command[0] == "arm-none-eabi-gcc":
        # Otherwise the compiler replaces the loop in memcpy() by a call of memcpy().
        common.append("-fno-tree-loop-distribute-patterns")
        common.append("-fno-code-hoisting")  # from version 14 on, it makes steps slower
        return ["-mthumb", f"-mcpu={chip.core}", *common, "-Wl,--gc-sections", "-lgcc"]
    target = ["-target", "thumb-freestanding-eabi", f"-mcpu={chip.core.replace('-', '_')}"]
    common.remove("-nostdlib")  # -nostdlib would also remove the support library of this compiler
    # Do not use the floating-point unit of an M4: it is off, and its registers are not saved.
    return [*target, "-mfloat-abi=soft", *common, "-Wl,--gc-sections"]


def enumerations(chip: Chip) -> dict[str, dict[str, int | tuple[int, int]]]:
    """The pin enumeration: the first pin of each port, with its number and the count."""
    counts: dict[str, tuple[int, int]] = {}
    for pin in chip.pins:
        number = pin_number(chip, pin)
        first, count = number // 32 * 32, number % 32 + 1
        name = f"{pin.rstrip('0123456789')}0"
        counts[name] = (first, max(counts.get(name, (0, 0))[1], count))
    return {"pin": dict(counts)}


def constants(board: ArmBoard) -> dict[str, Constant]:
    """The constants of the chip that the host needs."""
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
    chip = board.chip
    code = sources(board, firmware)
    content, tables = write_board(
        code,
        board_header(board),
        output,
        version=version,
        constants=constants(board),
        enumerations=enumerations(chip),
    )
    script = memory(chip) + (firmware / "hal" / "arm" / "link.ld").read_text(encoding="utf-8")
    (output / "image.ld").write_text(script, encoding="utf-8")
    elf, image = output / "passo.elf", output / "passo.bin"
    folders = [output, *(firmware / f for f in ("core", "hal", "hal/common"))]
    include = [f"-I{folder}" for folder in (*folders, *_layer(firmware, chip))]
    words = [*command, *include, *map(str, (*code, *tables)), *flags(command, chip)]
    words += [f"-Wl,-T,{output / 'image.ld'}"]
    done = subprocess.run([*words, "-o", str(elf)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise FirmwareError(done.stderr.strip())
    parts = segments(elf.read_bytes())
    data = flash_content(parts, chip)
    if chip.key in STAGED:
        data = with_boot_sum(data)
    image.write_bytes(data)
    in_ram = (p for p in parts if chip.ram_start <= p.run < chip.ram_start + chip.ram_bytes)
    ram = sum(p.size for p in in_ram)
    if len(data) > chip.flash_bytes or ram > chip.ram_bytes - STACK:
        raise FirmwareError(f"{len(data)} bytes of flash, {ram} of RAM: more than {chip.name} has")
    return Image(elf, image, len(data), ram, content)


def segments(elf: bytes) -> list[Segment]:
    """The segments that a 32-bit little-endian ELF file loads. Raises FirmwareError for another
    file."""
    if elf[:6] != b"\x7fELF\x01\x01":
        raise FirmwareError("the compiler made no ELF file")
    (offset,) = struct.unpack_from("<I", elf, 28)
    size, count = struct.unpack_from("<HH", elf, 42)
    parts: list[Segment] = []
    for at in range(offset, offset + size * count, size):
        kind, begin, run, load, in_file, in_memory = struct.unpack_from("<6I", elf, at)
        if kind == _LOAD and in_memory:
            if begin + in_file > len(elf):
                raise FirmwareError("the ELF file is cut short")
            parts.append(Segment(load, run, elf[begin : begin + in_file], in_memory))
    return parts


def flash_content(parts: list[Segment], chip: Chip) -> bytes:
    """The content of the flash from its start on. Raises FirmwareError if a segment begins before
    it."""
    data = bytearray()
    for part in sorted(parts, key=lambda part: part.load):
        if not part.content:
            continue
        at = part.load - chip.flash_start
        if at < len(data):
            raise FirmwareError(f"0x{part.load:08x} is not an address in the flash of {chip.name}")
        data += b"\xff" * (at - len(data)) + part.content
    return bytes(data)
