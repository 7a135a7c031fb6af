"""The Python client of the HTTP interface. Its calls come from the table of operations."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from http.client import HTTPConnection, HTTPException, HTTPSConnection
from typing import Any, cast
from urllib.parse import quote, urlencode, urlsplit

import msgspec

from passo.errors import Problem
from passo.web.answers import JSON, Fault, Refusal, fault
from passo.web.operation import HEADER, Operation
from passo.web.operations import OPERATIONS

_CALLS = {(operation.group, operation.verb): operation for operation in OPERATIONS}
_GROUPS = {operation.group for operation in OPERATIONS}
_DEFAULT_URL = "http://127.0.0.1:4000"
_TIMEOUT_S = 30.0


class RequestError(Exception):
    """A request has failed. `status` is the HTTP status, or 0 if the printer could not be reached;
    `fault` is the error, with its code, values and next action."""

    def __init__(self, status: int, fault: Fault) -> None:
        super().__init__(f"{fault.message}. {fault.action}.")
        self.status, self.fault = status, fault

    def __reduce__(self) -> tuple[object, ...]:
        """Pickles the error with its status and fault."""
        return type(self), (self.status, self.fault), self.__dict__


@dataclass(frozen=True, slots=True)
class _Request:
    method: str
    target: str  # path and query
    headers: dict[str, str]
    body: bytes | None


class _UnixConnection(HTTPConnection):
    """HTTP on a Unix socket of this computer."""

    def __init__(self, path: str, timeout_s: float) -> None:
        super().__init__("localhost", timeout=timeout_s)
        self._path = path

    def connect(self) -> None:
        """Like `HTTPConnection.connect`."""
        self.sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.sock.settimeout(self.timeout)
        self.sock.connect(self._path)


def _connector(url: str, timeout_s: float) -> Callable[[], HTTPConnection]:
    """A function that makes a connection to an address. Raises ValueError."""
    parts = urlsplit(url)
    if parts.scheme == "unix" and parts.path and not parts.netloc:
        return partial(_UnixConnection, parts.path, timeout_s)
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise ValueError(
            f"{url!r} is not the address of a printer: expected http://HOST:PORT or unix:PATH"
        )
    kind = HTTPSConnection if parts.scheme == "https" else HTTPConnection
    return partial(kind, parts.hostname, parts.port, timeout=timeout_s)


class _Connection:
    """The address of the printer, and the API key."""

    def __init__(self, url: str, key: str | None, timeout_s: float) -> None:
        self._connect = _connector(url, timeout_s)
        self._base = "" if url.startswith("unix:") else urlsplit(url).path.rstrip("/")
        self._url = url
        self._headers = {HEADER: "1"} | ({"X-Api-Key": key} if key else {})

    def exchange(self, request: _Request) -> bytes:
        """Sends a request; returns the body of the answer. Raises RequestError."""
        connection = self._connect()
        try:
            headers = self._headers | request.headers
            connection.request(request.method, self._base + request.target, request.body, headers)
            response = connection.getresponse()
            status, body = response.status, response.read()
            cookie = response.getheader("Set-Cookie")
        except (OSError, HTTPException) as error:
            raise RequestError(0, _unreachable(self._url, str(error))) from error
        finally:
            connection.close()
        if cookie is not None:
            self._headers["Cookie"] = cookie.partition(";")[0]
        if status >= 400:
            raise RequestError(status, self._refused(status, body))
        return body

    def _refused(self, status: int, body: bytes) -> Fault:
        try:
            return msgspec.json.decode(body, type=Refusal).error
        except msgspec.DecodeError:
            return _unreachable(self._url, f"an answer with status {status} is not of Passo")


def _unreachable(url: str, why: str) -> Fault:
    return fault(Problem("web.unreachable", values={"value": url, "limit": why}))


def _request(operation: Operation, given: tuple[Any, ...], named: dict[str, Any]) -> _Request:
    """The request of a call. Raises TypeError for arguments that do not fit."""
    body = _fields(operation.body)
    query = _fields(operation.query)
    raw = ["data"] if operation.consumes != JSON else []
    order = [*operation.parameters, *raw, *body, *query]
    if len(given) > len(order):
        raise TypeError(f"{operation.name} takes {len(order)} arguments, not {len(given)}")
    values = dict(zip(order, given, strict=False))
    if wrong := next((name for name in named if name not in order or name in values), None):
        raise TypeError(f"{operation.name} has no argument {wrong}, or it is given twice")
    values |= named
    needed = [*operation.parameters, *raw]
    needed += [name for name, required in {**body, **query}.items() if required]
    if missing := next((name for name in needed if name not in values), None):
        raise TypeError(f"{operation.name} needs {missing}")
    path = operation.template
    for name in operation.parameters:
        path = path.replace(f"{{{name}}}", quote(str(values[name]), safe="/"))
    pairs = {name: _text(values[name]) for name in query if values.get(name) is not None}
    target = f"{path}?{urlencode(pairs)}" if pairs else path
    headers: dict[str, str] = {}
    content: bytes | None = None
    if operation.body is not None:
        content = msgspec.json.encode({name: values[name] for name in body if name in values})
        headers["Content-Type"] = JSON
    elif raw:
        content = cast("bytes", values["data"])
        headers["Content-Type"] = operation.consumes
    return _Request(operation.method, target, headers, content)


def _fields(kind: Any) -> dict[str, bool]:
    """The fields of a type of request, and whether each is required."""
    if kind is None:
        return {}
    return {field.encode_name: field.required for field in msgspec.structs.fields(kind)}


def _text(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _answer(operation: Operation, body: bytes) -> Any:
    if operation.produces != JSON:
        return body
    if operation.response is None:
        return None
    return msgspec.json.decode(body, type=operation.response)


class _Group:
    """The operations of one noun."""

    def __init__(self, client: Client | AsyncClient, group: str) -> None:
        self._client, self._group = client, group

    def __getattr__(self, verb: str) -> Any:
        """A call of an operation."""
        operation = _CALLS.get((self._group, verb))
        if operation is None:
            raise AttributeError(f"there is no operation {self._group}.{verb}")

        def call(*given: Any, **named: Any) -> Any:
            return self._client.call(operation, _request(operation, given, named))

        return call


class Client:
    """A served printer: `client.heaters.set("hotend", 200)`.

    `url` is the address of `passo serve` (`http://HOST:PORT` or `unix:PATH`), `key` an API key. The
    arguments of a call are the parameters of its path, and then the fields of its request, in the
    order of docs/reference/http.md. Calls raise RequestError. Threads may share a client."""

    def __init__(
        self, url: str = _DEFAULT_URL, *, key: str | None = None, timeout_s: float = _TIMEOUT_S
    ) -> None:
        self._connection = _Connection(url, key, timeout_s)

    def __getattr__(self, group: str) -> Any:
        """The operations of a noun."""
        if group not in _GROUPS:
            raise AttributeError(f"there are no operations {group}")
        return _Group(self, group)

    def call(self, operation: Operation, request: Any) -> Any:
        """One exchange."""
        return _answer(operation, self._connection.exchange(request))


class AsyncClient:
    """Like `Client`, with awaitable calls: `await client.heaters.set("hotend", 200)`. Each call
    runs in a worker thread of the event loop."""

    def __init__(
        self, url: str = _DEFAULT_URL, *, key: str | None = None, timeout_s: float = _TIMEOUT_S
    ) -> None:
        self._connection = _Connection(url, key, timeout_s)

    def __getattr__(self, group: str) -> Any:
        """The operations of a noun."""
        if group not in _GROUPS:
            raise AttributeError(f"there are no operations {group}")
        return _Group(self, group)

    async def call(self, operation: Operation, request: Any) -> Any:
        """One exchange."""
        return _answer(operation, await asyncio.to_thread(self._connection.exchange, request))
