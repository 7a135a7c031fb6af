"""A file that arrives as a form, from a browser or a slicer, and is written directly to the
card."""

from __future__ import annotations

from collections.abc import AsyncGenerator, Callable, Mapping
from contextlib import aclosing
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.errors import InputError
from passo.web.files.form import Field, FileBegins, FileData, Form, Part

if TYPE_CHECKING:
    from passo.web.files.body import Body
    from passo.web.files.incoming import Incoming
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
    """Receives a form with at most one file, which is put on the card when the form is complete.
    `target` returns the confined path of the file from the fields before it and its name. The field
    `checksum`, if there is one, is the SHA-256 of the file. Raises the errors of `Uploads.file` and
    `Form`."""
    fields: dict[str, str] = {}
    async with aclosing(_parts(body)) as parts:
        async for part in parts:
            if isinstance(part, Field):
                fields[part.name] = part.value
            elif isinstance(part, FileBegins):
                path = target(fields, part.name)
                async with uploads.file(path, room=body.length or 0) as incoming:
                    await _receive_file(parts, incoming, fields)
                    incoming.sha256 = fields.get("checksum", "")
                return FormUpload(fields, path, incoming.offset)
    return FormUpload(fields, "", 0)


async def _receive_file(
    parts: AsyncGenerator[Part], incoming: Incoming, fields: dict[str, str]
) -> None:
    """Receives the file and the fields after it."""
    async for part in parts:
        if isinstance(part, FileData):
            await incoming.write(part.data)
        elif isinstance(part, Field):
            fields[part.name] = part.value
        elif isinstance(part, FileBegins):
            raise InputError.of("upload.malformed", value="it has more than one file")


async def _parts(body: Body) -> AsyncGenerator[Part]:
    form = Form(body.type)
    async with aclosing(body.pieces()) as pieces:
        async for data in pieces:
            for part in form.feed(data):
                yield part
    form.finish()
