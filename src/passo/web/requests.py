"""Reads a request: its body, its query, the parameters of its path."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import msgspec
from anyio import fail_after

from passo.errors import WebError
from passo.web.answers import JSON

if TYPE_CHECKING:
    from starlette.requests import Request

    from passo.web.operation import Operation

BODY_S = 20.0  # maximum time until a request in JSON is complete
_AT = re.compile(r"(?P<what>.*?)(?: - at `(?:key in )?\$(?P<path>.*)`)?\Z", re.DOTALL)
_STEP = re.compile(r"\.(\w+)|\[(\d+|\.\.\.)\]")


async def arguments(operation: Operation, request: Request) -> dict[str, Any]:
    """The arguments for the handler, without the call. Raises WebError for values that do not match
    the declaration."""
    found = {
        name: _converted("path", request.path_params[name], kind, name)
        for name, kind in operation.parameters.items()
    }
    if operation.query is not None:
        found["query"] = _query(request, operation.query)
    elif request.query_params and not operation.compatible:
        name = next(iter(request.query_params))
        raise _invalid("query", f"/{name}", "this request has no query")
    if operation.body is not None:
        found["body"] = await _body(request, operation)
    return found


async def limited(request: Request, most: int) -> bytes:
    """Reads the body of a request, of at most `most` bytes, within `BODY_S`. Raises WebError."""
    body = bytearray()
    try:
        with fail_after(BODY_S):
            async for part in request.stream():
                body += part
                if len(body) > most:
                    raise WebError.of("web.too-large", limit=most)
    except TimeoutError:
        raise WebError.of("web.slow", limit=f"{BODY_S:g}") from None
    return bytes(body)


async def _body(request: Request, operation: Operation) -> Any:
    kind = request.headers.get("content-type", "")
    if kind.partition(";")[0].strip().lower() != JSON:
        raise WebError.of("web.media-type", value=kind, limit=JSON)
    data = await limited(request, operation.max_body)
    try:
        return msgspec.json.decode(data, type=operation.body)
    except msgspec.ValidationError as error:
        raise _refused("body", str(error), "") from None
    except (msgspec.DecodeError, RecursionError, UnicodeDecodeError) as error:
        raise WebError.of("web.malformed", value=error) from None


def _query(request: Request, kind: Any) -> Any:
    pairs = request.query_params.multi_items()
    names = [name for name, _ in pairs]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise _invalid("query", f"/{twice}", "it is given twice")
    return _converted("query", dict(pairs), kind, "")


def _converted(where: str, value: Any, kind: Any, name: str) -> Any:
    try:
        return msgspec.convert(value, kind, strict=False)
    except msgspec.ValidationError as error:
        raise _refused(where, str(error), name) from None


def _refused(where: str, text: str, name: str) -> WebError:
    """The error for a text of msgspec, with the place as a JSON pointer (RFC 6901)."""
    found = _AT.match(text)
    assert found is not None
    steps = _STEP.findall(found["path"] or "")
    pointer = "".join(f"/{key or index}" for key, index in steps)
    return _invalid(where, f"/{name}" if name else pointer, found["what"].replace("`", ""))


def _invalid(where: str, pointer: str, why: str) -> WebError:
    return WebError.of("web.invalid", where=where, pointer=pointer, value=why)
