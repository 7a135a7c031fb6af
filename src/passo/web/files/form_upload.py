"""A file that arrives as a form, from a browser or a slicer, and is written directly to the
card."""

from __future__ import annotations

from collections.abc import AsyncGenerator, Callable, Mapping
from contextlib import aclosing
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.errors import InputError
from passo.web.files.form import Field, FileBegins, FileData, FileEnds, Form, Part

if TYPE_CHECKING:
    from passo.web.files.body import Body
    from passo.web.files.uploads import Uploads


@dataclass(frozen=True, slots=True)
class FormUpload:
    """A received form: its fields, and the path of its file on the card; empty without a file."""

    fields: Mapping[str, str]
    path: str
    size: int


async def receive_form(
    body: Body, uploads: Uploads, target: Callable[[Mapping[str, str], str], str]
) -> FormUpload:
    """Receives a form with at most one file. `target` returns the confined path of the file from
    the fields before it and its name. Raises the errors of `Uploads.file` and `Form`."""
    fields: dict[str, str] = {}
    path, size = "", 0
    async with aclosing(_parts(body)) as parts:
        async for part in parts:
            if isinstance(part, Field):
                fields[part.name] = part.value
            elif isinstance(part, FileBegins):
                if path:
                    raise InputError.of("upload.malformed", value="it has more than one file")
                path = target(fields, part.name)
                async with uploads.file(path, room=body.length or 0) as incoming:
                    async for more in parts:
                        if isinstance(more, FileData):
                            await incoming.write(more.data)
                        elif isinstance(more, FileEnds):
                            break
                    size = incoming.offset
    return FormUpload(fields, path, size)


async def _parts(body: Body) -> AsyncGenerator[Part]:
    form = Form(body.type)
    async with aclosing(body.pieces()) as pieces:
        async for data in pieces:
            for part in form.feed(data):
                yield part
    form.finish()
