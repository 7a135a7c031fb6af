"""The web's thread: a real-time event loop in which an ASGI application is served."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
import threading
from collections.abc import Callable, Coroutine, Generator
from functools import partial
from typing import TYPE_CHECKING, Any, cast

import uvicorn

from passo.errors import InputError
from passo.web.protocol import LimitedProtocol

if TYPE_CHECKING:
    from starlette.types import ASGIApp

_log = logging.getLogger(__name__)
_FRAME = 1 << 16  # bytes of a WebSocket message
_BACKLOG = 128


def _web_socket(**given: Any) -> asyncio.Protocol:
    """The protocol of a connection that becomes a WebSocket."""
    from passo.web.web_socket import LimitedWebSocket

    return LimitedWebSocket(**given)


def configuration(app: ASGIApp) -> uvicorn.Config:
    """The configuration of uvicorn for an application."""
    return uvicorn.Config(
        app,
        http=LimitedProtocol,
        lifespan="off",
        ws=cast("type[asyncio.Protocol]", _web_socket),  # uvicorn only calls it
        ws_per_message_deflate=False,
        ws_max_size=_FRAME,
        access_log=False,
        log_config=None,
        server_header=False,
        proxy_headers=False,
        timeout_graceful_shutdown=1,
    )


class _Server(uvicorn.Server):
    """A server that leaves signals to the program, and has nothing to do without connections."""

    def __init__(self, config: uvicorn.Config) -> None:
        self._ended = asyncio.Event()
        super().__init__(config)

    @property
    def should_exit(self) -> bool:
        """Whether the server must end. Set it in the event loop of the server."""
        return self._ended.is_set()

    @should_exit.setter
    def should_exit(self, value: bool) -> None:  # pyright: ignore[reportIncompatibleVariableOverride]
        if value:
            self._ended.set()

    @contextlib.contextmanager
    def capture_signals(self) -> Generator[None]:
        """Leaves the handlers of signals as they are."""
        yield

    async def main_loop(self) -> None:
        """Returns when the server must end."""
        await self._ended.wait()


def server(app: ASGIApp) -> uvicorn.Server:
    """A server that leaves signals to the program: `serve(sockets=[…])` serves the application
    until `should_exit` is set."""
    return _Server(configuration(app))


class WebThread:
    """Runs coroutines in a separate thread with an event loop in real time, independent of the time
    of the printer's loop. Create and close it in any other thread."""

    def __init__(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run, name="web", daemon=True)
        self._tasks: set[asyncio.Task[None]] = set()
        self._closers: list[Callable[[], object]] = []
        self._thread.start()

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        self._loop.run_forever()
        for task in self._tasks:
            task.cancel()
        self._loop.run_until_complete(asyncio.gather(*self._tasks, return_exceptions=True))
        self._loop.run_until_complete(self._loop.shutdown_default_executor())
        self._loop.close()

    def start(self, main: Coroutine[Any, Any, None], *, endless: bool = False) -> None:
        """Runs a coroutine until it ends or the thread is closed. `close` waits for it, or cancels
        it at once if it is `endless`."""

        def begin() -> None:
            task = self._loop.create_task(main)
            self._tasks.add(task)
            task.add_done_callback(self._ended)
            if endless:
                self._closers.append(lambda: self._loop.call_soon_threadsafe(task.cancel))

        self._loop.call_soon_threadsafe(begin)

    def _ended(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        if not task.cancelled() and (error := task.exception()) is not None:
            _log.error("The web has failed: %s", error, exc_info=error)

    def serve(
        self, app: ASGIApp, listening: socket.socket, at_end: Callable[[], object] | None = None
    ) -> None:
        """Serves an application on a listening socket. `close` calls `at_end` first."""
        served = server(app)
        if at_end is not None:
            self._closers.append(at_end)
        end = partial(setattr, served, "should_exit", True)
        self._closers.append(lambda: self._loop.call_soon_threadsafe(end))
        self.start(served.serve(sockets=[listening]))

    def close(self) -> None:
        """Ends all connections and the thread; returns when the thread has ended."""
        for closer in self._closers:
            closer()
        asyncio.run_coroutine_threadsafe(self._wait(), self._loop).result()
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()

    async def _wait(self) -> None:
        if self._tasks:
            await asyncio.wait(list(self._tasks), timeout=3)


def listening(host: str, port: int) -> socket.socket:
    """A listening socket; port 0 is any free port. Raises InputError."""
    place = f"{host}:{port}"
    try:
        family, kind, proto, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        found = socket.socket(family, kind, proto)
        try:
            found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            found.bind(address)
            found.listen(_BACKLOG)
        except OSError:
            found.close()
            raise
    except OSError as error:
        raise InputError.of(
            "console.unopened", axis=f"http {place}", value=error.strerror or str(error)
        ) from None
    return found
