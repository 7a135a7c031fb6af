"""The port of a board: in this process, on a serial line, or at a network address."""

from __future__ import annotations

import errno
import os
import socket
import time
from collections.abc import Callable, Sequence
from typing import Protocol, TypeAlias

from passo import _core
from passo.errors import MachineError
from passo.serial_line import open_serial_line

_TIMEOUT_S = 5.0
_REOPEN_S = 0.1  # between two attempts to open a port

Wire: TypeAlias = "_core.Pump | _core.LiveWire"
Simulated: TypeAlias = "_core.Bench | _core.Distant"


class LinkLostError(MachineError):
    """The board cannot be reached any more."""


class Port(Protocol):
    """A port to which a link can be attached. On a `live` port, real time passes at the board even
    if no caller waits. `byte_s` is the transmission time of a byte in seconds, or None if it is not
    known."""

    live: bool
    byte_s: float

    def open(self, timeout_s: float = 0.0) -> None:
        """Opens the port for the next `attach`, which otherwise opens it itself. On a `live` port
        this may take seconds; any thread may call it. It retries for `timeout_s`, because the
        device of a board that restarts is missing for a while. Raises MachineError."""
        ...

    def close(self) -> None:
        """Closes the port. `open` and `attach` open it again."""
        ...

    def attach(self, link: _core.Link) -> Wire:
        """Connects a link to this port, and returns the transport, which carries bytes from now on.
        Raises MachineError."""
        ...


class InProcess:
    """A board of this process. Its virtual time starts at `start_clock`, in ticks of its clock, or
    it shares the time of another board, `beside`."""

    live = False
    byte_s = 0.0

    def __init__(
        self, device: Simulated, start_clock: int = 0, beside: InProcess | None = None
    ) -> None:
        self.device = device
        self.unplugged = self._cut = False
        self._clock = start_clock
        self._beside = beside
        self._pump: _core.Pump | None = None
        self._link: _core.Link | None = None

    def unplug(self) -> None:
        """Unplugs the cable."""
        self.unplugged = self._cut = True
        if self._pump is not None:
            self._pump.cut()

    def plug(self, clock: int) -> None:
        """Lets the board run without its cable until `clock`, and then plugs the cable in again."""
        self.unplugged = False
        self._clock = clock

    def open(self, timeout_s: float = 0.0) -> None:
        """Does nothing: the port is always open."""

    def close(self) -> None:
        """Does nothing: the port is always open."""

    def attach(self, link: _core.Link) -> _core.Pump:
        """Returns a pump: the earlier one if the link is the same and its cable was not unplugged,
        otherwise a new one whose time continues that of the earlier one. A board `beside` another
        one joins the pump of that board, which must be attached first."""
        if self.unplugged:
            raise _unreachable("the simulated board", OSError("it is unplugged"))
        if self._beside is not None and self._beside._pump is not None:
            self._beside._pump.attach(link, self.device)
            return self._beside._pump
        if self._pump is None or link is not self._link or self._cut:
            clock = self._clock if self._pump is None else max(self._clock, self._pump.now)
            self._pump, self._link, self._cut = _core.Pump(link, self.device, clock), link, False
        return self._pump


def in_process(devices: Sequence[Simulated]) -> list[InProcess]:
    """Boards of this process that share their time, the main one first."""
    main = InProcess(devices[0])
    return [main, *(InProcess(device, beside=main) for device in devices[1:])]


class LivePort:
    """A board on a cable: a thread carries the bytes. `opened` opens the device and returns its
    descriptor; it raises MachineError."""

    live = True

    def __init__(self, opened: Callable[[], int], byte_s: float = 0.0) -> None:
        self._opened = opened
        self.byte_s = byte_s
        self._wire: _core.LiveWire | None = None
        self._descriptor: int | None = None  # opened, but not attached yet

    def open(self, timeout_s: float = 0.0) -> None:
        """Opens the port again, and closes the transport that was attached before. Raises
        MachineError."""
        self.close()
        last_s = time.monotonic() + timeout_s
        while self._descriptor is None:
            try:
                self._descriptor = self._opened()
            except LinkLostError:
                if time.monotonic() >= last_s:
                    raise
                time.sleep(_REOPEN_S)

    def close(self) -> None:
        """Closes the device, and the transport that was attached."""
        if self._wire is not None:
            self._wire.stop()
            self._wire = None
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None

    def attach(self, link: _core.Link) -> _core.LiveWire:
        """Returns a transport with a thread of its own. Opens the port first unless `open` has done
        so. Raises MachineError."""
        if self._descriptor is None:
            self.open()
        assert self._descriptor is not None
        self._wire, self._descriptor = _core.LiveWire(link, self._descriptor), None
        return self._wire


def serial_port(device: str, baud: int, *, paced: bool = False) -> LivePort:
    """A board on a serial device. Opening the device resets many boards. `paced`: a byte takes the
    time of ten bits at the baud rate. False for the USB port of the chip itself, which ignores the
    baud rate."""

    def opened() -> int:
        try:
            return open_serial_line(device, baud)
        except OSError as error:
            raise _unreachable(device, error) from None

    return LivePort(opened, 10 / baud if paced else 0.0)


def tcp_port(host: str, port: int) -> LivePort:
    """A board at a network socket."""

    def opened() -> int:
        try:
            connected = socket.create_connection((host, port), _TIMEOUT_S)
        except OSError as error:
            raise _unreachable(f"{host}:{port}", error) from None
        connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return connected.detach()

    return LivePort(opened)


def _unreachable(place: str, error: OSError) -> LinkLostError:
    if error.errno == errno.EBUSY:
        return LinkLostError.of("machine.port-in-use", axis=place)
    return LinkLostError.of("machine.unreachable", axis=place, value=error.strerror or str(error))
