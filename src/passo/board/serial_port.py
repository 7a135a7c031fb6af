"""Serial ports of this computer, at any rate that their drivers can do."""

from __future__ import annotations

import fcntl
import os
import struct
import termios
import tty

_TCGETS2, _TCSETS2 = 0x802C542A, 0x402C542B
_BOTHER, _CBAUD = 0o010000, 0o010017


def open_serial_port(device: str, baud: int) -> int:
    """The file descriptor of a serial device, raw and not blocking. Raises OSError."""
    port = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    try:
        tty.setraw(port)
        attributes = bytearray(44)
        fcntl.ioctl(port, _TCGETS2, attributes, True)
        inputs, outputs, control, local, line, keys, _, _ = struct.unpack("4IB19s2I", attributes)
        control = (control & ~_CBAUD) | _BOTHER | termios.CLOCAL | termios.CREAD
        termios2 = struct.pack("4IB19s2I", inputs, outputs, control, local, line, keys, baud, baud)
        fcntl.ioctl(port, _TCSETS2, termios2)
    except (OSError, termios.error) as error:
        os.close(port)
        raise error if isinstance(error, OSError) else OSError(*error.args) from None
    return port
