"""The same job gives the same stream on old and new PCs, and breaks no rule of C++."""

from __future__ import annotations

import pytest

from .builds import EXPECTED, stream_of

BUILDS = {
    "x86-64 with AVX2": ["-DPASSO_NO_CLONES", "-march=x86-64-v3"],
    "x86-64 baseline, with address and undefined behaviour sanitizers": [
        "-DPASSO_NO_CLONES",
        "-O1",  # it compiles in half of the time
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover=all",
    ],
}


@pytest.mark.parametrize("name", BUILDS)
def test_x86_stream_is_the_same(name, tmp_path):
    assert stream_of(name, ["g++", *BUILDS[name]], [], tmp_path) == EXPECTED
