"""Reads the comments of a slicer in a file: the slicer's name, thumbnails, objects."""

from __future__ import annotations

import base64
import binascii
import re
from collections.abc import Iterable
from dataclasses import dataclass, field

_MAX_THUMBNAILS = 16
_MAX_OBJECTS = 1000
_SLICER = re.compile(
    r";\s*(?:G-Code )?(?:generated (?:by|with)|sliced by)\s+(.{1,80}?)(?:\s+on\s.*|\s+at\s.*)?$",
    re.IGNORECASE,
)
_BEGIN = re.compile(r";\s*thumbnail(?:_(JPG|QOI|PNG))? begin (\d{1,4})x(\d{1,4}) (\d{1,7})")
_END = re.compile(r";\s*thumbnail(?:_\w+)? end")
_OBJECT = re.compile(
    r"EXCLUDE_OBJECT_DEFINE\s.*?NAME=(?:'([^']*)'|\"([^\"]*)\"|(\S+))|M486\b.*?\sA(.+)"
)
_KINDS = {  # media types by the first bytes of the picture
    "image/png": b"\x89PNG\r\n\x1a\n",
    "image/jpeg": b"\xff\xd8\xff",
    "image/qoi": b"qoif",
}


@dataclass(frozen=True, slots=True)
class Thumbnail:
    """A picture of the print: its size in pixels, its media type, and its bytes."""

    width: int
    height: int
    kind: str
    data: bytes = field(repr=False)


@dataclass(frozen=True, slots=True)
class Comments:
    """The slicer's name and version, empty if the file does not have it; the thumbnails, smallest
    first; the names of the objects that can be cancelled."""

    slicer: str
    thumbnails: tuple[Thumbnail, ...]
    objects: tuple[str, ...]


def read_comments(lines: Iterable[str]) -> Comments:
    """Reads the comments in the first lines of a file. Malformed comments are ignored."""
    slicer = ""
    thumbnails: list[Thumbnail] = []
    objects: dict[str, None] = {}
    begun: re.Match[str] | None = None
    text: list[str] = []
    for line in lines:
        if begun is not None:
            if _END.match(line):
                if picture := _thumbnail(begun, "".join(text)):
                    thumbnails.append(picture)
                begun = None
            else:
                text.append(line.lstrip("; ").rstrip())
        elif line.startswith(";"):
            if len(thumbnails) < _MAX_THUMBNAILS and (begun := _BEGIN.match(line)):
                text = []
            elif not slicer and (found := _SLICER.match(line.rstrip())):
                slicer = found[1].strip()
        elif len(objects) < _MAX_OBJECTS and (found := _OBJECT.match(line)):
            name = next(group for group in found.groups() if group is not None)
            objects[name.strip().strip('"')] = None
    thumbnails.sort(key=lambda picture: picture.width * picture.height)
    return Comments(slicer, tuple(thumbnails), tuple(objects))


def _thumbnail(begun: re.Match[str], text: str) -> Thumbnail | None:
    try:
        data = base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError):
        return None
    kind = next((kind for kind, head in _KINDS.items() if data.startswith(head)), None)
    if kind is None or len(text) != int(begun[4]):
        return None
    return Thumbnail(int(begun[2]), int(begun[3]), kind, data)
