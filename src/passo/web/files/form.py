"""A body of `multipart/form-data`, read in pieces: fields, and one file that is never completely in
memory.

Sources: RFC 7578 (form data), RFC 2047 and RFC 5987 (names beyond ASCII), which clients mix.
"""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass
from email.header import decode_header
from typing import TypeAlias
from urllib.parse import unquote_to_bytes

from python_multipart.exceptions import FormParserError
from python_multipart.multipart import MultipartParser

from passo.errors import InputError

_MAX_FIELDS = 32
_MAX_FIELD_BYTES = 8192
_BOUNDARY = re.compile(r'boundary=(?:"([^"]{1,200})"|([^\s;"]{1,200}))', re.IGNORECASE)
_NAME = re.compile(rb';\s*name="?([^";]*)"?', re.IGNORECASE)
_FILE_NAME = re.compile(rb';\s*filename="((?:[^"\\]|\\.)*)"|;\s*filename=([^";]*)', re.IGNORECASE)
_CODED_NAME = re.compile(rb";\s*filename\*=([\w-]+)'[^']*'([^;\s]+)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Field:
    """A complete field."""

    name: str
    value: str


@dataclass(frozen=True, slots=True)
class FileBegins:
    """A file begins. The name is the client's, decoded."""

    field: str
    name: str


@dataclass(frozen=True, slots=True)
class FileData:
    """The next bytes of the file."""

    data: bytes


@dataclass(frozen=True, slots=True)
class FileEnds:
    """The file is complete."""


Part: TypeAlias = Field | FileBegins | FileData | FileEnds


class Form:
    """Takes a body in pieces of any size, and returns its parts in order. For a malformed body,
    this call and all later ones raise InputError `upload.malformed`."""

    def __init__(self, content_type: str) -> None:
        found = _BOUNDARY.search(content_type)
        if not content_type.lower().startswith("multipart/form-data") or not found:
            raise _malformed("expected multipart/form-data with a boundary")
        self._found: list[Part] = []
        self._name = self._header = b""
        self._headers: dict[bytes, bytes] = {}
        self._field = ""
        self._value: bytearray | None = None  # None: a file
        self._fields = 0
        self._over = False
        try:
            self._parser = MultipartParser(
                (found[1] or found[2]).encode("latin-1", "replace"),
                {
                    "on_part_begin": self._begin,
                    "on_header_field": self._on_name,
                    "on_header_value": self._on_value,
                    "on_header_end": self._on_header,
                    "on_headers_finished": self._on_headers,
                    "on_part_data": self._on_data,
                    "on_part_end": self._on_end,
                    "on_end": self._on_over,
                },
            )
        except FormParserError as error:
            raise _malformed(str(error)) from None

    def feed(self, data: bytes) -> list[Part]:
        """The parts that these bytes complete."""
        try:
            self._parser.write(data)
        except FormParserError as error:
            raise _malformed(str(error)) from None
        found, self._found = self._found, []
        return found

    def finish(self) -> None:
        """Call this at the end of the body. Raises InputError if the form is not complete."""
        if not self._over:
            raise _malformed("it ends before its last boundary")

    def _begin(self) -> None:
        self._fields += 1
        if self._fields > _MAX_FIELDS:
            raise _malformed(f"it has more than {_MAX_FIELDS} fields")
        self._headers = {}
        self._name = self._header = b""

    def _on_name(self, data: bytes, start: int, end: int) -> None:
        self._name += data[start:end]

    def _on_value(self, data: bytes, start: int, end: int) -> None:
        self._header += data[start:end]

    def _on_header(self) -> None:
        self._headers[self._name.lower()] = self._header
        self._name = self._header = b""

    def _on_headers(self) -> None:
        disposition = self._headers.get(b"content-disposition", b"")
        name = _NAME.search(disposition)
        if name is None:
            raise _malformed("a field has no name")
        self._field = name[1].decode("utf-8", "replace")
        file = _file_name(disposition)
        self._value = bytearray() if file is None else None
        if file is not None:
            self._found.append(FileBegins(self._field, file))

    def _on_data(self, data: bytes, start: int, end: int) -> None:
        if self._value is None:
            self._found.append(FileData(data[start:end]))
            return
        self._value += data[start:end]
        if len(self._value) > _MAX_FIELD_BYTES:
            raise _malformed(f"the field {self._field} has more than {_MAX_FIELD_BYTES} bytes")

    def _on_end(self) -> None:
        if self._value is None:
            self._found.append(FileEnds())
        else:
            self._found.append(Field(self._field, self._value.decode("utf-8", "replace")))

    def _on_over(self) -> None:
        self._over = True


def _file_name(disposition: bytes) -> str | None:
    """The file's name, in any of its encodings; None if the part is not a file."""
    if coded := _CODED_NAME.search(disposition):
        try:
            return unquote_to_bytes(coded[2]).decode(coded[1].decode("ascii"))
        except (UnicodeDecodeError, LookupError):
            pass
    plain = _FILE_NAME.search(disposition)
    if plain is None:
        return None
    raw = re.sub(rb'\\(["\\])', rb"\1", plain[1]) if plain[1] is not None else plain[2].strip()
    return decoded_name(raw)


def decoded_name(raw: bytes) -> str:
    """A name in a header, decoded from UTF-8 or else Latin-1; encoded words of RFC 2047 are decoded
    too."""
    try:
        text = raw.decode("utf-8")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    if "=?" in text and "?=" in text:
        with suppress(ValueError, LookupError):  # an invalid encoded word stays as it is
            text = "".join(
                part if isinstance(part, str) else part.decode(charset or "latin-1")
                for part, charset in decode_header(text)
            )
    return text


def _malformed(why: str) -> InputError:
    return InputError.of("upload.malformed", value=why)
