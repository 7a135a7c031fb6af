"""Answers in JSON, and refusals: the sentences of what is wrong, with the status that fits."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec
from starlette.responses import Response

from passo.errors import PassoError

_STATUS = {
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
    "card.not-empty": 409,
    "card.read-only": 409,
    "job.printing": 409,
    "upload.binary": 415,
    "upload.kind": 415,
    "upload.content": 415,
    "input.empty": 415,
    "upload.slow": 408,
    "upload.too-many": 503,
    "upload.offset": 409,
    "command.halted": 409,
}


def json(body: object, status: int = 200, headers: Mapping[str, str] | None = None) -> Response:
    """An answer of JSON."""
    return Response(msgspec.json.encode(body), status, headers, "application/json")


def status_of(error: PassoError) -> int:
    """The HTTP status that fits what is wrong; 400 where none says more."""
    return _STATUS.get(error.problems[0].code, 400)


def refusal(error: PassoError) -> Response:
    """What is wrong, in sentences: `error` is the first, `problems` are all."""
    problems = [
        {"code": problem.code, "part": problem.entry.part, "text": str(problem)}
        for problem in error.problems
    ]
    return json({"error": problems[0]["text"], "problems": problems}, status_of(error))
