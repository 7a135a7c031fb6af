"""The same job gives the same stream on ARM, run in an emulator."""

from __future__ import annotations

import pytest

from .builds import EXPECTED, stream_of

BUILDS = {
    "AArch64": ("aarch64-linux-gnu-g++", "qemu-aarch64-static"),
    "32-bit ARM": ("arm-linux-gnueabihf-g++", "qemu-arm-static"),
}


@pytest.mark.parametrize("name", ["AArch64", pytest.param("32-bit ARM", marks=pytest.mark.long)])
def test_arm_stream_is_the_same(name, tmp_path):
    """In an emulator, which is slow; 32-bit computers differ from others in the width of `long`
    and in their registers alone, and few of them are left."""
    compiler, emulator = BUILDS[name]
    assert stream_of(name, [compiler, "-static"], [emulator], tmp_path) == EXPECTED
