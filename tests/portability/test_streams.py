"""The same job gives the same stream on every CPU: builds for four of them, run here."""

from __future__ import annotations

import lzma
import shutil
import subprocess
from pathlib import Path

import pytest

from .program import program

ROOT = Path(__file__).parents[2]
SOURCE = Path(__file__).with_name("stream.cpp")
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
cartesian 19800 3993624bd4178d67
corexy 22211 09ce06ec1bb98fa9
delta 42770 32c348851def650a
rotary_delta 37448 f47f62eff875383c
scara 30962 899adf29fe8cb1a3
short of commands 19751 13b200538a28ef56
above a bent bed 43466 5e505609be3e8242
demo 232871 6d670657abd8938c
gear_arcs 378449 c079d009cd04ff49
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
    words = [*compiler, *FLAGS, f"-I{ROOT / 'core'}", str(SOURCE), "-o", str(binary)]
    subprocess.run(words, check=True)
    words = [*emulator, str(binary), *sources]
    out = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    assert out == EXPECTED
