"""The same job gives the same stream on ARM, run in an emulator."""

from __future__ import annotations

import pytest

from .builds import EXPECTED, stream_of

BUILDS = {
    "AArch64": ("aarch64-linux-gnu-g++", "qemu-aarch64-static"),
    "32-bit ARM": ("arm-linux-gnueabihf-g++", "qemu-arm-static"),
}


@pytest.mark.parametrize("name", BUILDS)
def test_arm_stream_is_the_same(name, tmp_path):
    compiler, emulator = BUILDS[name]
    assert stream_of([compiler, "-static"], [emulator], tmp_path) == EXPECTED
