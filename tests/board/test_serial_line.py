"""The lock of a serial device."""

from __future__ import annotations

import errno
import fcntl
import os
import struct
from collections.abc import Iterator

import pytest

from passo.board.ports import LinkLostError, serial_port
from passo.serial_line import open_serial_line

_TIOCGEXCL = 0x80045440  # asm-generic/ioctls.h


@pytest.fixture
def device() -> Iterator[str]:
    """A pseudo-terminal whose program keeps both ends open, as Klipper's Linux process does."""
    ends = os.openpty()
    yield os.ttyname(ends[1])
    for end in ends:
        os.close(end)


def test_second_program_is_refused_while_the_first_runs(device: str) -> None:
    line = open_serial_line(device, 250_000)
    with pytest.raises(OSError, match=str(errno.EBUSY)):
        open_serial_line(device, 250_000)
    with pytest.raises(LinkLostError, match=f"another program has {device} open"):
        serial_port(device, 250_000).open()
    os.close(line)


def test_pseudo_terminal_can_be_opened_again_by_any_user(device: str) -> None:
    os.close(open_serial_line(device, 250_000))
    line = open_serial_line(device, 250_000)
    exclusive = fcntl.ioctl(line, _TIOCGEXCL, b"\0\0\0\0")
    assert struct.unpack("i", exclusive) == (0,)
    os.close(line)
