"""Opens serial devices at any baud rate that their driver supports."""

from __future__ import annotations

import fcntl
import os
import struct
import termios
import tty

# Any baud rate: termios2 of Linux (asm-generic/ioctls.h and termbits.h, as on x86 and ARM).
_TCGETS2, _TCSETS2 = 0x802C542A, 0x402C542B
_BOTHER, _CBAUD = 0o010000, 0o010017
_RPMSG = "/dev/rpmsg"  # a channel to a coprocessor (a PRU), which has no terminal settings


def open_serial_line(device: str, baud: int) -> int:
    """Opens a device for this program alone, raw and non-blocking, and returns its descriptor.
    Raises OSError."""
    line = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK | os.O_CLOEXEC)
    if device.startswith(_RPMSG) and not os.isatty(line):
        return line
    try:
        fcntl.ioctl(line, termios.TIOCEXCL)
        tty.setraw(line)
        attributes = bytearray(44)
        fcntl.ioctl(line, _TCGETS2, attributes, True)
        inputs, outputs, control, local, rule, keys, _, _ = struct.unpack("4IB19s2I", attributes)
        control = (control & ~_CBAUD) | _BOTHER | termios.CLOCAL | termios.CREAD
        changed = struct.pack("4IB19s2I", inputs, outputs, control, local, rule, keys, baud, baud)
        fcntl.ioctl(line, _TCSETS2, changed)
        termios.tcflush(line, termios.TCIOFLUSH)
    except (OSError, termios.error) as error:
        os.close(line)
        raise error if isinstance(error, OSError) else OSError(*error.args) from None
    return line
