"""Identifies the board on a serial port, to verify that the flashed firmware runs."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import os
import termios

from passo.board.dictionary import DictionaryError
from passo.board.identify import Identification
from passo.serial_line import open_serial_line

_AT_ONCE = 4096


async def identify(port: str, baud: int, within_s: float = 10.0) -> Identification | None:
    """The dictionary of the board on a port; None if the board has not sent it within `within_s`
    seconds of the loop's time. Opening the port restarts many boards, which takes a second or two.
    Raises OSError if the port cannot be opened, or disappears."""
    loop = asyncio.get_running_loop()
    wire = open_serial_line(port, baud)
    found = Identification()
    arrived = asyncio.Event()
    gone: list[OSError] = []

    def read() -> None:
        try:
            data = os.read(wire, _AT_ONCE)
            if not data:  # the port was closed
                raise OSError(errno.EIO, os.strerror(errno.EIO))
            found.feed(data)
        except BlockingIOError:
            return
        except DictionaryError:
            loop.remove_reader(wire)  # no more data will arrive; `within_s` ends the wait
        except OSError as error:
            loop.remove_reader(wire)
            gone.append(error)
        arrived.set()

    try:
        _forget(wire)
        loop.add_reader(wire, read)
        end = loop.time() + within_s
        while found.dictionary is None and loop.time() < end:
            if gone:
                raise gone[0]
            data, again = found.poll(loop.time())
            if data:
                with contextlib.suppress(BlockingIOError):
                    os.write(wire, data)
            arrived.clear()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(arrived.wait(), min(again, end) - loop.time())
    finally:
        loop.remove_reader(wire)
        os.close(wire)
    return found if found.dictionary else None


def _forget(wire: int) -> None:
    """Discards the bytes so far. Raises OSError."""
    try:
        termios.tcflush(wire, termios.TCIOFLUSH)
    except termios.error as error:
        raise OSError(*error.args) from None
