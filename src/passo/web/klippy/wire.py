"""Frames of Klipper's socket: a JSON object and the byte 0x03, in both directions. Does no input or
output itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import msgspec

from passo.web.deltas import tree

LONGEST = 4 << 20  # bytes of a request; a longer one ends the connection
_END = b"\x03"


class FrameTooLongError(ValueError):
    """A request has more than LONGEST bytes."""


@dataclass(frozen=True, slots=True)
class Request:
    """A request of a client. Without an `id`, which is None then, it is not answered."""

    method: str
    params: dict[str, Any]
    id: object


class Frames:
    """Splits the bytes of a client into frames."""

    def __init__(self) -> None:
        self._begun = bytearray()

    def feed(self, data: bytes) -> list[bytes]:
        """Returns the frames that `data` completes, in order. Raises FrameTooLongError."""
        *ended, rest = data.split(_END)
        frames: list[bytes] = []
        for part in ended:
            self._add(part)
            frames.append(bytes(self._begun))
            self._begun.clear()
        self._add(rest)
        return frames

    def _add(self, part: bytes) -> None:
        if len(self._begun) + len(part) > LONGEST:
            raise FrameTooLongError
        self._begun += part


def request_of(frame: bytes) -> Request:
    """The request in a frame. Raises ValueError, with a sentence, if it is not a request."""
    try:
        found = msgspec.json.decode(frame)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        raise ValueError("it is not JSON") from None
    if not isinstance(found, dict):
        raise ValueError("it is not an object")
    fields = cast("dict[str, Any]", found)
    method, params = fields.get("method"), fields.get("params", {})
    if not isinstance(method, str):
        raise ValueError("its method is not a text")
    if not isinstance(params, dict):
        raise ValueError("its params are not an object")
    return Request(method, cast("dict[str, Any]", params), fields.get("id"))


def frame_of(message: dict[str, Any]) -> bytes:
    """The frame of a message to a client. Numbers that are not finite become null."""
    return msgspec.json.encode(tree(message)) + _END
