"""Time for programs at both ends of a serial line, which stands still while one of them works."""

from __future__ import annotations

import ctypes
import os
import subprocess
import threading
import time
import tty
from collections.abc import Callable
from pathlib import Path
from typing import Protocol, TypeVar

SOURCE = Path(__file__).with_suffix(".c")
LOOK_NS = 2_000_000
SECOND_NS = 1_000_000_000

T = TypeVar("T")


class SharedClock:
    """What it does is told in shared_clock.c. `environment` lets another program take part."""

    def __init__(self, folder: Path) -> None:
        made, clock = folder / "shared_clock.so", folder / "clock"
        flags = ["-std=gnu11", "-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC"]
        subprocess.run(["cc", *flags, SOURCE, "-o", made], check=True)
        self._library = ctypes.CDLL(str(made))
        self._library.shared_clock_now.restype = ctypes.c_int64
        self._library.shared_clock_wait.argtypes = [ctypes.c_int, ctypes.c_int64]
        self._library.shared_clock_wait.restype = ctypes.c_bool
        self._library.shared_clock_open.restype = ctypes.c_bool
        assert self._library.shared_clock_open(str(clock).encode())
        self.environment = os.environ | {"LD_PRELOAD": str(made), "SHARED_CLOCK": str(clock)}

    @property
    def now_ns(self) -> int:
        return self._library.shared_clock_now()

    def wait(self, fd: int, until_ns: int) -> bool:
        """Until then, or until there is something to read: true."""
        return self._library.shared_clock_wait(fd, until_ns)

    def pass_s(self, seconds: float) -> None:
        """Returns when so much has passed for the others."""
        until_ns = self.now_ns + seconds * SECOND_NS
        while self.now_ns < until_ns:
            time.sleep(0.01)


class Device(Protocol):
    """A board; `now` in ticks of its clock."""

    def poll(self, now: int, /) -> bytes: ...
    def feed(self, data: bytes, now: int, /) -> None: ...


class SharedLine:
    """A board at one end of a pty, by a shared clock; hosts open the serial device `path`."""

    def __init__(self, clock: SharedClock, device: Device, clock_hz: int) -> None:
        self._clock, self._device, self._hz = clock, device, clock_hz
        self._began_ns = clock.now_ns
        self._master, self._slave = os.openpty()  # the host's end stays open: hosts come and go
        tty.setraw(self._slave)
        self.path = os.ttyname(self._slave)
        self._guard = threading.Lock()
        self._stopping = False
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def _now(self) -> int:
        return (self._clock.now_ns - self._began_ns) * self._hz // SECOND_NS

    def _serve(self) -> None:
        while not self._stopping:
            with self._guard:
                said = self._device.poll(self._now())
            os.write(self._master, said)
            if self._clock.wait(self._master, self._clock.now_ns + LOOK_NS):
                heard = os.read(self._master, 4096)
                with self._guard:
                    self._device.feed(heard, self._now())

    def look(self, at: Callable[[], T]) -> T:
        """What a function of the board returns, while the board stands still."""
        with self._guard:
            return at()

    def close(self) -> None:
        """The board stands still; it may be looked at now."""
        self._stopping = True
        self._thread.join()
        os.close(self._master)
        os.close(self._slave)
