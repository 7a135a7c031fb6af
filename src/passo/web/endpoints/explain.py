"""Explains one line of G-code: words, planned moves, steps, bytes on the link."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.catalogue import codes_of
from passo.learn.explanation import Explanation
from passo.web.call import Call
from passo.web.files.names import confined
from passo.web.operation import operation
from passo.web.roles import Role


class LineOfFile(Struct, forbid_unknown_fields=True):
    """A line of a file of the card, counted from 1."""

    path: str
    line: Annotated[int, Meta(ge=1, le=2**31 - 1)]


class TypedLine(Struct, forbid_unknown_fields=True):
    """One line of G-code, with lines to execute before and after it, such as `M204` and adjacent
    moves."""

    line: Annotated[str, Meta(min_length=1, max_length=1000, pattern=r"^[^\r\n]*[^\s][^\r\n]*$")]
    before: Annotated[str, Meta(max_length=4000)] = ""
    after: Annotated[str, Meta(max_length=4000)] = ""


_ERRORS = (
    *codes_of("input"),
    *("card.absent", "card.not-found", "card.name", "card.directory", "card.changed"),
    "output.unwritable",
)


@operation("explain.file", "GET", "/explain", Role.VIEWER, errors=_ERRORS)
async def explain_file(call: Call, query: LineOfFile) -> Explanation:
    """Explains a line of a file of the card, as `passo explain` shows it. A simulated board prints
    the file until the line is done, which takes seconds for a late line of a long file."""
    return await call.bridge.explain(confined(query.path), query.line)


@operation("explain.line", "POST", "/explain", Role.VIEWER, errors=_ERRORS)
async def explain_line(call: Call, body: TypedLine) -> Explanation:
    """Explains one line. All axes start at 0, before the lines of `before`. Nothing moves."""
    return await call.bridge.explain_line(body.line, before=body.before, after=body.after)
