"""The routes of all operations: each checks the caller and the request, calls the handler, and
answers."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, cast

from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response
from starlette.routing import Route

from passo.errors import PassoError, WebError
from passo.web.answers import Answer, json, refusal
from passo.web.deltas import tree
from passo.web.operation import Caller, Operation
from passo.web.requests import arguments

if TYPE_CHECKING:
    from starlette.types import Receive, Scope, Send

    from passo.web.access import Access
    from passo.web.call import ServerCall

_log = logging.getLogger(__name__)


def routes(
    operations: Sequence[Operation],
    access: Access,
    call: Callable[[Caller, Request], ServerCall],
) -> list[Route]:
    """A route for each path; `call` makes the first argument of the handlers."""
    paths: dict[str, dict[str, Operation]] = {}
    for operation in operations:
        methods = paths.setdefault(operation.path, {})
        if operation.method in methods:
            raise ValueError(f"{operation.method} {operation.path} is declared twice")
        methods[operation.method] = operation
    return [Route(path, _Endpoint(methods, access, call)) for path, methods in paths.items()]


class _Endpoint:
    """The operations of one path, as an ASGI application."""

    def __init__(
        self,
        methods: dict[str, Operation],
        access: Access,
        call: Callable[[Caller, Request], ServerCall],
    ) -> None:
        self._methods, self._access, self._call = methods, access, call

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        request = Request(scope, receive, send)
        method = "GET" if request.method == "HEAD" else request.method
        if (operation := self._methods.get(method)) is None:
            expected = ", ".join(sorted(self._methods))
            error = WebError.of("web.method", value=request.method, limit=expected)
            response = refusal(error, {"Allow": expected})
        else:
            response = await self._answer(operation, request)
        await response(scope, receive, send)

    async def _answer(self, operation: Operation, request: Request) -> Response:
        access = self._access
        try:
            caller = access.caller(request, writes=operation.writes)
            access.permit(caller, operation)
            await access.used(caller)
            given = await arguments(operation, request)
            answer = await operation.handler(self._call(caller, request), **given)
            if operation.writes and caller.name:
                _log.info("%s by %s", operation.name, caller.name)
        except PassoError as error:
            return refusal(error)
        except ClientDisconnect:
            return Response(status_code=499)  # the client has disconnected
        except Exception as error:
            _log.exception("%s %s failed", operation.method, operation.path)
            return refusal(WebError.of("web.program", value=type(error).__name__))
        return _response(answer, operation.status)


def _response(answer: object, status: int) -> Response:
    if isinstance(answer, Response):
        return answer
    if answer is None:
        return Response(status_code=204)
    if isinstance(answer, Answer):
        told = cast("Answer[object]", answer)
        return json(tree(told.body), status, told.headers)
    return json(tree(answer), status)


async def _not_found(request: Request, _: Exception) -> Response:
    return refusal(WebError.of("web.not-found", value=request.url.path))


async def _malformed(_: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    return refusal(WebError.of("web.malformed", value=error.detail))


# Errors of the framework, in JSON like all others.
EXCEPTION_HANDLERS = {404: _not_found, HTTPException: _malformed}
