"""The example files, unpacked."""

from __future__ import annotations

import lzma
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def unpacked(tmp_path_factory: pytest.TempPathFactory):
    """A function from the name of a packed file to the path of the unpacked one."""
    folder = tmp_path_factory.mktemp("gcode")

    def unpack(name: str) -> str:
        packed = next(
            p
            for p in (*ROOT.glob("examples/*.xz"), *ROOT.glob("tests/data/*.xz"))
            if p.name == f"{name}.gcode.xz"
        )
        path = folder / f"{name}.gcode"
        if not path.exists():
            path.write_bytes(lzma.decompress(packed.read_bytes()))
        return str(path)

    return unpack
