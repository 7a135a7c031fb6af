"""One client of Klipper's socket: its requests, and the messages to it. Does no input or output
itself."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Mapping
from typing import Any, Protocol

from passo.errors import PassoError
from passo.web.klippy.arguments import Arguments, RequestError
from passo.web.klippy.subscriptions import Lookup, Subscription
from passo.web.klippy.wire import Frames, Request, frame_of, request_of

_log = logging.getLogger(__name__)

_MAX_PENDING = 1000  # maximum of open requests of a client


class TooManyRequestsError(Exception):
    """A client has too many open requests."""


class Methods(Protocol):
    """The methods that requests may call."""

    async def answer(
        self, client: Connection, method: str, arguments: Arguments
    ) -> Mapping[str, Any]:
        """The result of a request. Raises RequestError, PassoError."""
        ...


class Connection:
    """A client. Requests start in the order of arrival; their answers may come in another order.
    `send` sends a frame, and never blocks. Use it in one event loop."""

    def __init__(self, methods: Methods, send: Callable[[bytes], None]) -> None:
        self._methods, self._send = methods, send
        self._frames = Frames()
        self._tasks: set[asyncio.Task[None]] = set()
        self.objects: Subscription | None = None
        self.output: dict[str, Any] | None = None  # the template of messages with console lines
        # methods that the client has registered, with their templates
        self.remote_methods: dict[str, dict[str, Any]] = {}

    def receive(self, data: bytes) -> None:
        """Handles bytes that the client has sent. Raises FrameTooLongError and
        TooManyRequestsError, after which the caller must close the connection."""
        for frame in self._frames.feed(data):
            try:
                request = request_of(frame)
            except ValueError as error:
                _log.warning("A request on Klipper's socket is not answered: %s", error)
                continue
            if len(self._tasks) >= _MAX_PENDING:
                raise TooManyRequestsError
            task = asyncio.get_running_loop().create_task(self._serve(request))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

    def tell(self, template: Mapping[str, Any], params: Mapping[str, Any]) -> None:
        """Sends the client a message made from a template."""
        self._send(frame_of({**template, "params": dict(params)}))

    def tell_output(self, text: str) -> None:
        """Sends the client a console line, if it has asked for them."""
        if self.output is not None:
            self.tell(self.output, {"response": text})

    def tell_changes(self, lookup: Lookup, event_s: float) -> None:
        """Sends the changes of the objects that the client has subscribed to."""
        if self.objects is not None and (news := self.objects.changed(lookup)):
            self.tell(self.objects.template, {"eventtime": event_s, "status": news})

    async def _serve(self, request: Request) -> None:
        answer = await _answered(
            self._methods.answer(self, request.method, Arguments(request.params)), request.method
        )
        if request.id is not None:
            self._send(frame_of({"id": request.id, **answer}))


async def _answered(result: Awaitable[Mapping[str, Any]], method: str) -> dict[str, Any]:
    """A result, or an error instead of it. A fault of the program becomes an error too, so that the
    printer continues."""
    try:
        return {"result": dict(await result)}
    except (RequestError, PassoError) as error:
        message = str(error)
    except Exception as error:
        _log.exception("Klipper's method %s has failed", method)
        message = f"Internal Error on {method}: {error!r}"
    return {"error": {"error": "WebRequestError", "message": message}}
