"""Builds of the core for several CPUs, and the streams that each of them must give. The tests are
in two files, so that two workers compile at a time."""

from __future__ import annotations

import lzma
import subprocess
from pathlib import Path

from tests.support.kept import kept

from .program import program

ROOT = Path(__file__).parents[2]
# The program, and the parts of the core on the way from a line to a step.
NOT_LINKED = ("bind", "heat", "link", "sim")
SOURCES = [
    *sorted(p for p in ROOT.glob("core/*/*.cpp") if p.parent.name not in NOT_LINKED),
    Path(__file__).with_name("stream.cpp"),
]
FLAGS = ["-std=c++20", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math"]
EXPECTED = """\
cartesian 22493 6e3c6b1a538b6c82
corexy 24568 72a81fb4ccbc3b8f
delta 43381 290df8468d7b82a4
rotary_delta 38195 a6416805b5b7e50f
scara 31425 ccf210b3065b0564
short of commands 22493 6e3c6b1a538b6c82
above a bent bed 44065 1393ad46f59376d1
filtered 28065 9941da0b4501f2ad
filtered, of limited jerk 31317 142f8a17fc6e1e0c
filtered corexy 36426 d981da0dbbe70f81
filtered delta 55273 6cb337357e7c45a0
demo 233747 c656834fbd4341d1
gear_arcs 381704 090c49892ad8227b
"""
# One that is shipped, and one with arcs.
EXAMPLES = ("examples/demo", "tests/data/gear_arcs")


def sources(folder: Path) -> list[str]:
    """The program, and the examples unpacked into the folder."""
    paths = [folder / "program.gcode"]
    paths[0].write_text(program())
    for name in EXAMPLES:
        paths.append(folder / f"{Path(name).name}.gcode")
        paths[-1].write_bytes(lzma.decompress((ROOT / f"{name}.gcode.xz").read_bytes()))
    return [str(path) for path in paths]


def stream_of(name: str, compiler: list[str], emulator: list[str], folder: Path) -> str:
    """The streams that a build of the core gives. It is compiled as one source, which is faster."""
    command = [compiler[0], *FLAGS, *compiler[1:], f"-I{ROOT / 'core'}"]

    def build(place: Path) -> Path:
        whole, binary = place / "whole.cpp", place / "stream"
        whole.write_text("".join(f'#include "{path}"\n' for path in SOURCES))
        subprocess.run([*command, str(whole), "-o", str(binary)], check=True)
        return binary

    made_from = (command, SOURCES, ROOT / "core", SOURCES[-1])
    binary = kept(f"stream-{name.replace(' ', '-')}", made_from, compiler[:1], build)
    words = [*emulator, str(binary), *sources(folder)]
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout
