"""Images for AVR chips: sources, flags, the board's header, and the checks of a build."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from passo.toolchain.declarations import Constant
from passo.toolchain.image import Image
from passo.toolchain.sources import TOO_FAST_FOR_AVR, core_sources
from passo.toolchain.tables import write_board

# Registers that belong to the interrupts of firmware/hal/avr: nothing else may use them.
RESERVED = tuple(range(2, 10))
_FREE_UNITS = 3
_RECEIVE_WINDOW = 192


class FirmwareError(ValueError):
    """An image that cannot be built, or that breaks a rule; the message says why."""


@dataclass(frozen=True, slots=True)
class Chip:
    """An AVR chip: its memories in bytes, its ports, and the compare units that can make steps, in
    the order of the priority of their interrupts (the alarm uses one more unit)."""

    flash: int
    ram: int
    ports: str
    units: tuple[str, ...]


CHIPS = {
    "atmega2560": Chip(
        flash=256 * 1024,
        ram=8192,
        ports="ABCDEFGHJKL",
        units=tuple(f"TIMER{timer}{unit}" for timer in (1, 3, 4, 5) for unit in "ABC")[:-1],
    ),
    "atmega1284p": Chip(
        flash=128 * 1024,
        ram=16384,
        ports="ABCD",
        units=tuple(f"TIMER{timer}{unit}" for timer in (1, 3) for unit in "AB"),
    ),
}
# The maximum pulse of a unit with fixed pins, in ticks (firmware/hal/avr/stepgen.c).
PULSE_TICKS = 34
# RAM must have space for a stack of this size in addition to the static data.
STACK = 900


@dataclass(frozen=True, slots=True)
class Motor:
    """A motor with fixed pins (`PF0`). `unit` names its compare unit (`TIMER3A`); by default it
    gets the first free one."""

    step_pin: str
    dir_pin: str
    unit: str | None = None


@dataclass(frozen=True, slots=True)
class AvrBoard:
    """The board of an image. Motors with other pins than those named here share the free units: at
    most three, or the number of `slow_motors`, whose drivers need longer pulses than PULSE_TICKS.
    `older_hosts`: the image uses the older protocol version."""

    mcu: str
    motors: tuple[Motor, ...] = ()
    slow_motors: int = 0
    clock_hz: int = 16_000_000
    baud: int = 250_000
    older_hosts: bool = False

    @property
    def chip(self) -> Chip:
        """The data of the chip. Raises FirmwareError for a chip that the firmware does not
        support."""
        if self.mcu not in CHIPS:
            raise FirmwareError(f"no firmware for {self.mcu}: {', '.join(CHIPS)} are known")
        return CHIPS[self.mcu]

    def assigned(self) -> tuple[list[tuple[Motor, str]], list[str]]:
        """The motors with their units, and the free units. Raises FirmwareError if a unit does not
        exist, is claimed twice, or there are more motors than units."""
        left = list(self.chip.units)
        for motor in self.motors:
            if motor.unit is None:
                continue
            if motor.unit not in left:
                raise FirmwareError(
                    f"{motor.step_pin}: {motor.unit} is taken, or {self.mcu} has it not to spare"
                )
            left.remove(motor.unit)
        if sum(m.unit is None for m in self.motors) + self.slow_motors > len(left):
            raise FirmwareError(f"{self.mcu} drives at most {len(self.chip.units)} motors")
        fixed = [(m, m.unit or left.pop(0)) for m in self.motors]
        return fixed, left[: max(_FREE_UNITS, self.slow_motors)]


def board_header(board: AvrBoard) -> str:
    """board.h for firmware/hal/avr. Raises FirmwareError."""
    fixed, free = board.assigned()
    rows = [
        f"S({n}, {unit[-2]}, {unit[-1]}, {_pin(motor.step_pin)}, {_pin(motor.dir_pin)})"
        for n, (motor, unit) in enumerate(fixed)
    ]
    spare = [f"S({len(fixed) + n}, {unit[-2]}, {unit[-1]})" for n, unit in enumerate(free)]
    return "\n".join(
        [
            "// Made by the build.",
            "#pragma once",
            f"#define BOARD_CLOCK_HZ {board.clock_hz}UL",
            f"#define BOARD_BAUD {board.baud}UL",
            f"#define BOARD_UNITS {len(fixed) + len(free)}",
            "#define BOARD_FIXED(S) " + " ".join(rows),
            "#define BOARD_FREE(S) " + " ".join(spare),
            "",
        ]
    )


def _pin(name: str) -> str:
    match = re.fullmatch(r"P([A-L])([0-7])", name)
    if match is None:
        raise FirmwareError(f"{name} is not a pin of an AVR chip")
    return f"{match[1]}, {match[2]}"


def sources(board: AvrBoard, firmware: Path) -> list[Path]:
    """The sources of an image, below the folder `firmware`."""
    found = [
        *core_sources(firmware, older_hosts=board.older_hosts, without=TOO_FAST_FOR_AVR),
        *firmware.glob("hal/avr/*.c"),
        *firmware.glob("hal/avr/*.S"),
    ]
    return sorted(found)


def flags(board: AvrBoard) -> list[str]:
    """The flags with which avr-gcc compiles and links a board's sources."""
    return [
        f"-mmcu={board.mcu}",
        f"-DF_CPU={board.clock_hz}UL",
        *(["-std=gnu11", "-O2", "-Wall", "-Wextra", "-flto", "-fuse-linker-plugin"]),
        # From version 10 on, -O2 inlines functions, which makes this code slower.
        *(["-fno-inline-functions", "-ffunction-sections", "-fdata-sections", "-fshort-enums"]),
        *(["-Wl,--gc-sections,--relax"]),
        *(f"-ffixed-r{n}" for n in RESERVED),
    ]


def enumerations(board: AvrBoard) -> dict[str, dict[str, int | tuple[int, int]]]:
    """The pin enumeration: eight pins for each port, counted from port A."""
    ports = {f"P{p}0": ((ord(p) - ord("A")) * 8, 8) for p in board.chip.ports}
    return {"pin": {**ports}}


def constants(board: AvrBoard) -> dict[str, Constant]:
    """The constants of the chip that the host needs."""
    return {
        "CLOCK_FREQ": board.clock_hz,
        "MCU": board.mcu,
        "SERIAL_BAUD": board.baud,
        "RECEIVE_WINDOW": _RECEIVE_WINDOW,
        "ADC_MAX": 1023,
        "PWM_MAX": 255,
        "RESERVE_PINS_serial": "PE0,PE1" if board.mcu == "atmega2560" else "PD0,PD1",
    }


def declared(
    board: AvrBoard, code: Sequence[Path], output: Path, version: str
) -> tuple[dict[str, Any], list[Path]]:
    """Like `write_board`, for this board."""
    return write_board(
        code,
        board_header(board),
        output,
        version=version,
        constants=constants(board),
        enumerations=enumerations(board),
    )


def check_sizes(board: AvrBoard, flash: int, ram: int) -> None:
    """Raises FirmwareError if an image of this size, and a stack, do not fit the chip."""
    if flash > board.chip.flash or ram > board.chip.ram - STACK:
        raise FirmwareError(f"{flash} bytes of flash, {ram} of RAM: more than {board.mcu} has")


def build(board: AvrBoard, firmware: Path, output: Path, version: str = "") -> Image:
    """Builds an image with avr-gcc into the folder `output`.

    Raises FirmwareError if avr-gcc is missing or fails, if the image is too large, or if anything
    but the interrupts uses a reserved register.
    """
    code = sources(board, firmware)
    content, tables = declared(board, code, output, version)
    elf, image = output / "passo.elf", output / "passo.hex"
    folders = [output, firmware / "core", firmware / "hal", firmware / "hal" / "avr"]
    include = [f"-I{folder}" for folder in folders]
    _run(["avr-gcc", *flags(board), *include, *map(str, [*code, *tables]), "-o", str(elf)])
    _run(["avr-objcopy", "-O", "ihex", "-R", ".eeprom", str(elf), str(image)])
    sizes = _sizes(elf)
    flash = sizes[".text"] + sizes.get(".data", 0)
    ram = sizes.get(".data", 0) + sizes.get(".bss", 0)
    check_sizes(board, flash, ram)
    offenders = reserved_register_users(_compiled(elf))
    if offenders:
        raise FirmwareError(f"registers of the interrupts are used by {', '.join(offenders)}")
    return Image(elf, image, flash, ram, content)


def _run(command: Sequence[str]) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        raise FirmwareError(f"{command[0]} is missing") from error
    if done.returncode != 0:
        raise FirmwareError(done.stderr.strip())
    return done.stdout


def _compiled(elf: Path) -> str:
    """The disassembly without the code of the interrupts and the constant tables before it."""
    symbols = (line.split() for line in _run(["avr-nm", str(elf)]).splitlines())
    start = next(row[0] for row in symbols if row[-1] == "__ctors_end")
    return _run(["avr-objdump", "-d", f"--start-address=0x{start}", str(elf)])


def _sizes(elf: Path) -> dict[str, int]:
    lines = _run(["avr-size", "-A", str(elf)]).splitlines()
    rows = (line.split() for line in lines if line.startswith("."))
    return {row[0]: int(row[1]) for row in rows}


def reserved_register_users(disassembly: str) -> list[str]:
    """Names of the functions that use a reserved register; newer compilers also print addresses
    within functions."""
    users: list[str] = []
    function = ""
    for line in disassembly.splitlines():
        label = re.match(r"[0-9a-f]+ <(.+)>:", line)
        if label:
            function = function if re.match(r"\.L|L\d", label[1]) else label[1]
            continue
        parts = line.split("\t")
        if len(parts) < 4:
            continue
        operands = parts[3].split(";")[0]
        used = {int(n) for n in re.findall(r"\br(\d+)\b", operands)}
        if parts[2] == "movw":
            used |= {n + 1 for n in used}
        if used & set(RESERVED) and function not in users:
            users.append(function)
    return users
