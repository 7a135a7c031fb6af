"""The last frames of a link as text, for the report of a halt."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from passo import _core
from passo.board.configuration import Oids
from passo.board.description import BoardDescription
from passo.board.dictionary import Dictionary, frame_lines

KEPT_S = 2.0  # before a halt
# Enough for that time: at most 130 kB/s in at most 4000 parts per second.
KEPT_BYTES, KEPT_PARTS = 1 << 18, 1 << 13
_MAX_LINES = 8000  # of one board


@dataclass(frozen=True, slots=True)
class RecordedFrames:
    """The frames of one board around a halt at the host time `halt_ticks`. `parts` are (host time,
    clock of the board or 0, from the board, bytes), oldest first; times are ticks of the nominal
    frequency of the board."""

    name: str
    board: BoardDescription
    dictionary: Dictionary
    oids: Oids
    halt_ticks: int
    parts: list[tuple[int, int, bool, bytes]]

    def lines(self) -> list[str]:
        """A line for each message: seconds relative to the halt, direction, clock of the board as
        the host knew it then, message. If there are too many, only the newest."""
        lines = [*self._lines()]
        if len(lines) <= _MAX_LINES:
            return lines
        return [f"({len(lines) - _MAX_LINES} older messages left out)", *lines[-_MAX_LINES:]]

    def _lines(self) -> Iterator[str]:
        labels = self._labels()
        down = _core.Formats(list(self.dictionary.commands)), _core.FrameScanner()
        up = _core.Formats(list(self.dictionary.reports)), _core.FrameScanner()
        for host, clock, from_board, data in self.parts:
            formats, scanner = up if from_board else down
            seconds = (host - self.halt_ticks) / self.board.clock_hz
            head = f"{seconds:+10.6f} {'board' if from_board else 'host '} {clock or '-':>12}"
            for frame in scanner.feed(data):
                try:
                    messages = frame_lines(frame, formats, labels)
                except ValueError as error:  # sent before the dictionary was read
                    messages = [f"({error}: {frame[1].hex() if frame else ''})"]
                for message in messages:
                    yield f"{head}  {message}"

    def _labels(self) -> dict[tuple[str, int], str]:
        """The names of parts by the numbers in messages, as (parameter, value)."""
        kinds = {
            "stepper": self.oids.steppers,
            "output": self.oids.outputs,
            "sensor": self.oids.sensors,
            "endstop": self.oids.endstops,
            "trsync": self.oids.trsyncs,
        }
        labels = {
            ("oid", oid): f"{kind} {name}"
            for kind, names in kinds.items()
            for name, oid in names.items()
        }
        reasons = self.dictionary.enumerations.get("static_string_id", {})
        return labels | {("static_string_id", number): text for text, number in reasons.items()}
