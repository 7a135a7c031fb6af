"""Where a line of a file begins, as the interpreter counts lines."""

from __future__ import annotations

import io

import pytest

from passo.job.live.line_offsets import line_of_offset, offset_of_line


@pytest.mark.parametrize("shift", range(5))
@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"])
def test_offset_of_a_line(end, shift):
    """Line ends lie in turn on both sides of the border between two pieces."""
    line = b"x" * (255 - len(end)) + end
    data = b";" * shift + line * 800
    starts = [0] + [shift + 255 * i for i in range(1, 801)]
    for number in (1, 2, 256, 257, 258, 259, 514, 515, 516, 801):
        begin = starts[number - 1]
        assert offset_of_line(io.BytesIO(data), number) == begin
        assert line_of_offset(io.BytesIO(data), begin) == number
        assert line_of_offset(io.BytesIO(data), begin + 9) == number
    assert offset_of_line(io.BytesIO(data), 900) == len(data)


def test_a_border_within_cr_lf():
    data = b"x" * 65535 + b"\r\nsecond\r\n"
    assert offset_of_line(io.BytesIO(data), 2) == 65537
    assert offset_of_line(io.BytesIO(data), 3) == 65545
    assert [line_of_offset(io.BytesIO(data), at) for at in (65530, 65537, 65545)] == [1, 2, 3]
