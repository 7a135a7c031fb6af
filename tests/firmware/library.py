"""The firmware in the words of older hosts, as a library and as the host process; and with further
modules."""

from __future__ import annotations

import subprocess
from collections.abc import Iterable
from pathlib import Path

from tests.support import kept

from passo.toolchain.declarations import gather
from passo.toolchain.sources import core_sources
from passo.toolchain.tables import dictionary, write_tables

FIRMWARE = Path(__file__).parents[2] / "firmware"
CLOCK_HZ = 16_000_000
MOVES = 1024
PORTS = "ABCDEFGHIJKL"


def library_for_older_hosts() -> Path:
    core = core_sources(FIRMWARE, older_hosts=True)
    made_from = (*kept.FIRMWARE, Path(__file__))
    return kept.kept("older-library", made_from, ["cc"], lambda folder: _library(folder, core))


def library_with(folder: Path, *modules: Path) -> Path:
    """Made in `folder`: the core and these sources."""
    return _library(folder, [*core_sources(FIRMWARE), *modules])


def process_for_older_hosts() -> Path:
    """A program, with the pins of an ATmega2560."""
    additions = {
        "constants": {"CLOCK_FREQ": CLOCK_HZ},
        "enumerations": {"pin": {f"P{port}0": (8 * i, 8) for i, port in enumerate(PORTS)}},
    }
    flags = [f"-DPROCESS_CLOCK_HZ={CLOCK_HZ}", f"-DPROCESS_MOVES={MOVES}"]
    core = core_sources(FIRMWARE, older_hosts=True)

    def make(folder: Path) -> Path:
        layer = ["host.c", "process.c"]
        return _compile(folder, core, layer, flags, additions, folder / "process")

    return kept.kept("older-process", (*kept.FIRMWARE, Path(__file__)), ["cc"], make)


def _library(folder: Path, core: list[Path]) -> Path:
    flags = ["-shared", "-fPIC"]
    return _compile(folder, core, ["host.c"], flags, {}, folder / "firmware.so")


def _compile(
    folder: Path,
    core: list[Path],
    layer: Iterable[str],
    flags: list[str],
    additions: dict,
    made: Path,
) -> Path:
    host = FIRMWARE / "hal/host"
    sources = [
        *core,
        FIRMWARE / "hal/common/stepgen.c",
        *(host / name for name in layer),
    ]
    found = gather(sources)
    sources += write_tables(found, dictionary(found, version="test", **additions), folder)
    folders = [FIRMWARE / "core", FIRMWARE / "hal", FIRMWARE / "hal/common", host, folder]
    subprocess.run(
        ["cc", "-std=c11", "-O2", "-fno-strict-aliasing", "-Wall", "-Wextra", "-Werror", *flags,
         *(f"-I{f}" for f in folders), *map(str, sources), "-o", str(made)],
        check=True,
    )  # fmt: skip
    return made
