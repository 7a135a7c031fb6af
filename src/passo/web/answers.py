"""Answers in JSON, and refusals: the error's sentence, with the matching status."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import msgspec
from msgspec import Struct
from starlette.responses import Response

from passo.catalogue import ExitStatus
from passo.errors import PassoError, Problem
from passo.printer.unfit_commands import plain_advice

JSON = "application/json"
_STATUS = {
    "web.log-in": 401,
    "web.role": 403,
    "web.host": 403,
    "web.origin": 403,
    "web.password": 403,
    "web.not-found": 404,
    "web.method": 405,
    "web.too-large": 413,
    "web.media-type": 415,
    "web.too-many": 429,
    "web.unreachable": 502,
    "web.credentials": 401,
    "web.code": 401,
    "web.pairing": 401,
    "web.no-administrator": 403,
    "web.set-up": 409,
    "web.account-exists": 409,
    "web.last-administrator": 409,
    "web.accounts": 500,
    "web.slow": 408,
    "web.scripts": 429,
    "web.program": 500,
    "heat.unknown": 404,
    "input.cold": 409,
    "input.not-homed": 409,
    "command.aside": 409,
    "command.failed": 409,
    "command.fixed": 409,
    "command.no-mains": 409,
    "command.halted": 503,
    "config.unknown-machine": 404,
    "firmware.busy": 409,
    "firmware.board": 404,
    "machine.no-file": 409,
    "machine.no-folder": 409,
    "machine.file-changed": 409,
    "machine.no-restart": 409,
    "output.unwritable": 507,
    "queue.empty": 409,
    "queue.full": 409,
    "queue.bed": 409,
    "queue.unknown": 404,
    "learn.lesson": 404,
    "learn.calculator": 404,
    "learn.question": 404,
    "queue.unwritable": 507,
    "run.unknown": 404,
    "run.unwritable": 507,
    "run.damaged": 503,
    "settings.nowhere": 409,
    "settings.none": 409,
    "settings.unwritable": 507,
    "history.unusable": 503,
    "card.absent": 503,
    "card.removed": 503,
    "card.broken": 503,
    "card.not-found": 404,
    "card.full": 507,
    "card.busy": 409,
    "card.changed": 409,
    "card.exists": 409,
    "card.directory": 409,
    "card.not-directory": 409,
    "card.read-only": 409,
    "card.not-empty": 409,
    "card.into-itself": 409,
    "card.no-slots": 409,
    "upload.binary": 415,
    "upload.kind": 415,
    "upload.content": 415,
    "input.empty": 415,
    "upload.slow": 408,
    "upload.too-many": 503,
    "upload.offset": 409,
    "hub.unreachable": 502,
    "hub.refused": 409,
    "hub.code": 409,
    "hub.known": 409,
    "hub.state": 409,
    "hub.file-used": 409,
    "hub.limited": 403,
    "hub.no-space": 507,
    "hub.store": 500,
}


class Fault(Struct):
    """An error of the catalogue. `message` says what is wrong and where, `action` what to do next;
    `values` are those in the message."""

    code: str
    part: str
    message: str
    action: str
    values: dict[str, Any]


class Refusal(Struct):
    """The reason why a request was refused. `others` are further problems of the request."""

    error: Fault
    others: list[Fault] = []


_T = TypeVar("_T")


@dataclass(frozen=True, slots=True)
class Answer(Generic[_T]):
    """An answer with additional headers."""

    body: _T
    headers: Mapping[str, str]


def status_of(code: str) -> int:
    """The HTTP status of an error of the catalogue; the default is 400."""
    if (status := _STATUS.get(code)) is not None:
        return status
    if code.startswith("job."):
        return 409
    return 503 if Problem(code).entry.status is ExitStatus.MACHINE_FAULT else 400


def json(body: object, status: int = 200, headers: Mapping[str, str] | None = None) -> Response:
    """An answer of JSON."""
    return Response(msgspec.json.encode(body), status, headers, JSON)


def refusal(error: PassoError, headers: Mapping[str, str] | None = None) -> Response:
    """The error as an answer with a `Refusal`."""
    first, *others = [fault(problem) for problem in error.problems]
    status = status_of(first.code)
    known = {"WWW-Authenticate": 'Passo realm="printer"'} if status == 401 else {}
    if status == 429:
        known = {"Retry-After": str(first.values["limit"])}
    return json(Refusal(first, others), status, {**known, **(headers or {})})


def fault(problem: Problem) -> Fault:
    """A problem in the form for clients."""
    place = f"{problem.place}: " if problem.place else ""
    values = {name: _plain(value) for name, value in problem.values.items()}
    return Fault(
        problem.code, problem.entry.part, place + problem.sentence, plain_advice(problem), values
    )


def _plain(value: object) -> object:
    return value if isinstance(value, str | int | float | bool) else str(value)
