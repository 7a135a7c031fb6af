"""Plans files in a process of its own, so that planning delays neither the printer nor the web: a
thread would hold the interpreter lock, and hold it long where the computer is busy.

The process has a low priority. It reads the file from this process, piece by piece, because only
this process has the card."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from io import BufferedReader, BytesIO, RawIOBase
from typing import TYPE_CHECKING, Any, BinaryIO, Generic, Protocol, TypeVar, cast

from passo.card.api import Reader

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

_T = TypeVar("_T")
_R = TypeVar("_R", covariant=True)
_PIECE = 1 << 20  # bytes of a file read at once
_NICE = 10

TakePath = Callable[[bytes], None]


class Work(Protocol[_R]):
    """A picklable function that the process runs: it gets the file, its size in bytes, and a
    function that passes a planned path on to `Planning.take_path`."""

    def __call__(self, source: BinaryIO, size: int, take_path: TakePath, /) -> _R:
        """Returns a picklable result."""
        ...


class Planning(Generic[_T]):
    """One piece of work on a file. `run` it in a thread; any thread may `end` it."""

    def __init__(
        self,
        work: Work[_T],
        source: RawIOBase | BytesIO,
        size: int,
        take_path: TakePath | None = None,
    ) -> None:
        self._work, self._source, self._size = work, source, size
        self._take_path = take_path
        self.process: subprocess.Popen[bytes] | None = None
        self._ended = False

    def run(self) -> _T:
        """Returns what the work returns, and raises what it raises, and the errors of reading the
        file. Raises RuntimeError if the process was ended."""
        from multiprocessing import Pipe

        here, there = Pipe()
        with here:
            with there:
                command = [sys.executable, "-m", "passo.library.planning", str(there.fileno())]
                self.process = subprocess.Popen(
                    command, stdin=subprocess.DEVNULL, pass_fds=(there.fileno(),)
                )
            if self._ended:
                self.process.kill()
            try:
                here.send((self._work, self._size))
                return self._answer(here)
            except (EOFError, BrokenPipeError, ConnectionResetError):
                raise RuntimeError("the process that plans has ended") from None
            finally:
                self.process.kill()
                self.process.wait()

    def end(self) -> None:
        """Ends the process."""
        self._ended = True
        if self.process is not None:
            self.process.kill()

    def _answer(self, process: Connection) -> _T:
        while True:
            kind, value = process.recv()
            if kind == "read":
                offset, size = value
                self._source.seek(offset)
                process.send_bytes(self._source.read(size) or b"")
            elif kind == "path":
                path = process.recv_bytes()
                if self._take_path is not None:
                    self._take_path(path)
            elif kind == "failed":
                raise value
            else:
                return cast("_T", value)


def _serve(host: Connection) -> None:
    work, size = host.recv()

    def take_path(path: bytes) -> None:
        host.send(("path", None))
        host.send_bytes(path)

    def fetch(offset: int, into: memoryview) -> None:
        host.send(("read", (offset, len(into))))
        into[:] = host.recv_bytes()

    answer: tuple[str, Any]
    try:
        with BufferedReader(Reader(size, fetch, lambda: None), _PIECE) as source:
            answer = "done", work(source, size, take_path)
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return  # the result is no longer wanted
    except Exception as error:
        answer = "failed", error
    host.send(answer)


if __name__ == "__main__":
    from multiprocessing.connection import Connection

    os.nice(_NICE)
    with suppress(KeyboardInterrupt), Connection(int(sys.argv[1])) as to_host:
        _serve(to_host)
