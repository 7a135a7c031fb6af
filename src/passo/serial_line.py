"""Opens serial devices at any baud rate that their driver supports."""

from __future__ import annotations

import errno
import fcntl
import os
import struct
import termios
import tty

# Any baud rate: termios2 of Linux (asm-generic/ioctls.h and termbits.h, as on x86 and ARM).
_TCGETS2, _TCSETS2 = 0x802C542A, 0x402C542B
_BOTHER, _CBAUD = 0o010000, 0o010017
_PTY = "/dev/pts/"
_RPMSG = "/dev/rpmsg"  # a channel to a coprocessor (a PRU), which has no terminal settings


def open_serial_line(device: str, baud: int) -> int:
    """Opens a device for this program alone, raw and non-blocking, and returns its descriptor.
    Raises OSError: EBUSY if another program has it, such as a running Klipper, which locks its
    device too."""
    line = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK | os.O_CLOEXEC)
    if device.startswith(_RPMSG) and not os.isatty(line):
        return line
    try:
        fcntl.flock(line, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if not os.path.realpath(device).startswith(_PTY):
            # The mark ends when the last program closes the device. The process behind a
            # pseudo-terminal keeps it open, so that there it would outlive this program.
            fcntl.ioctl(line, termios.TIOCEXCL)
        tty.setraw(line)
        attributes = bytearray(44)
        fcntl.ioctl(line, _TCGETS2, attributes, True)
        inputs, outputs, control, local, rule, keys, _, _ = struct.unpack("4IB19s2I", attributes)
        control = (control & ~_CBAUD) | _BOTHER | termios.CLOCAL | termios.CREAD
        changed = struct.pack("4IB19s2I", inputs, outputs, control, local, rule, keys, baud, baud)
        fcntl.ioctl(line, _TCSETS2, changed)
        termios.tcflush(line, termios.TCIOFLUSH)
    except BlockingIOError:
        os.close(line)
        raise OSError(errno.EBUSY, os.strerror(errno.EBUSY), device) from None
    except (OSError, termios.error) as error:
        os.close(line)
        raise error if isinstance(error, OSError) else OSError(*error.args) from None
    return line
