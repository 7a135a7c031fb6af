"""Identifies a board over any transport: takes and returns bytes, and does no input or output
itself."""

from __future__ import annotations

from passo import _core
from passo.board.dictionary import Dictionary

_COMMANDS = [(1, "identify offset=%u count=%c")]
_REPORTS = [(0, "identify_response offset=%u data=%.*s")]
_CHUNK = 40
_RETRY_S = 0.25


class Identification:
    """Reads a board's data dictionary. Pass received bytes to `feed`, and send what `poll` returns.

    Times are seconds of any steady clock. The dictionary is complete when `dictionary` is set;
    `compressed` are its bytes as the board holds them.
    """

    def __init__(self) -> None:
        self.dictionary: Dictionary | None = None
        self.compressed = b""
        self._scanner = _core.FrameScanner()
        self._commands, self._reports = _core.Formats(_COMMANDS), _core.Formats(_REPORTS)
        self._sequence = 0
        self._asked_at: float | None = None

    def feed(self, data: bytes) -> None:
        """Takes bytes from the board, split anywhere. Raises DictionaryError if the dictionary is
        damaged."""
        for frame in self._scanner.feed(data):
            if frame is None or self.dictionary is not None:
                continue
            sequence, payload = frame
            if sequence != self._sequence:  # the sequence number that the board expects next
                if sequence != (self._sequence + 1) % 16:
                    self._asked_at = None
                self._sequence = sequence
            if payload and payload[0] == _REPORTS[0][0]:
                self._take(payload)

    def _take(self, payload: bytes) -> None:
        try:
            ((_, values),) = self._reports.decode(payload)
        except ValueError:
            return
        data = values["data"]
        if values["offset"] != len(self.compressed) or not isinstance(data, bytes):
            return
        self._asked_at = None
        if data:
            self.compressed += data
        else:
            self.dictionary = Dictionary.parse(self.compressed)

    def poll(self, now: float) -> tuple[bytes, float]:
        """Returns the bytes to send now, and the time of the next call if no bytes arrive before
        it."""
        if self.dictionary is not None:
            return b"", now + _RETRY_S
        if self._asked_at is not None and now < self._asked_at + _RETRY_S:
            return b"", self._asked_at + _RETRY_S
        self._asked_at = now
        payload = self._commands.encode("identify", [len(self.compressed), _CHUNK])
        return _core.make_frame(payload, self._sequence), now + _RETRY_S
