"""The same job gives the same stream on every CPU: builds for four of them, run here."""

from __future__ import annotations

import lzma
import shutil
import subprocess
from pathlib import Path

import pytest

from .program import program

ROOT = Path(__file__).parents[2]
# The program, and the parts of the core on the way from a line to a step.
NOT_LINKED = ("bind", "heat", "link", "sim")
SOURCES = [
    Path(__file__).with_name("stream.cpp"),
    *sorted(p for p in ROOT.glob("core/*/*.cpp") if p.parent.name not in NOT_LINKED),
]
FLAGS = ["-std=c++20", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math"]
BUILDS = {
    "x86-64 baseline": (["g++", "-DPASSO_NO_CLONES"], []),
    "x86-64 with AVX2": (["g++", "-DPASSO_NO_CLONES", "-march=x86-64-v3"], []),
    "AArch64": (["aarch64-linux-gnu-g++", "-static"], ["qemu-aarch64-static"]),
    "32-bit ARM": (["arm-linux-gnueabihf-g++", "-static"], ["qemu-arm-static"]),
    "address and undefined behaviour sanitizers": (
        ["g++", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"],
        [],
    ),
}
EXPECTED = """\
cartesian 22493 6e3c6b1a538b6c82
corexy 24568 72a81fb4ccbc3b8f
delta 43381 290df8468d7b82a4
rotary_delta 38195 a6416805b5b7e50f
scara 31425 ccf210b3065b0564
short of commands 22493 6e3c6b1a538b6c82
above a bent bed 44065 1393ad46f59376d1
demo 233747 c656834fbd4341d1
gear_arcs 381704 090c49892ad8227b
"""


EXAMPLES = ("examples/demo", "tests/data/gear_arcs")  # the one that is shipped, and one with arcs


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """The program, and the examples unpacked."""
    folder = tmp_path_factory.mktemp("portability")
    paths = [folder / "program.gcode"]
    paths[0].write_text(program())
    for name in EXAMPLES:
        paths.append(folder / f"{Path(name).name}.gcode")
        paths[-1].write_bytes(lzma.decompress((ROOT / f"{name}.gcode.xz").read_bytes()))
    return [str(path) for path in paths]


@pytest.mark.parametrize("name", BUILDS)
def test_the_stream_is_the_same(name, sources, tmp_path):
    compiler, emulator = BUILDS[name]
    assert shutil.which(compiler[0]), f"{compiler[0]} is missing: make test installs it"
    binary = tmp_path / "stream"
    words = [*compiler, *FLAGS, f"-I{ROOT / 'core'}", *map(str, SOURCES), "-o", str(binary)]
    subprocess.run(words, check=True)
    words = [*emulator, str(binary), *sources]
    out = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    assert out == EXPECTED
