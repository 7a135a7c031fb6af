"""A host that speaks to a simulated chip, a frame at a time, in the chip's own time."""

from __future__ import annotations

from passo import _core
from passo.board.dictionary import Dictionary
from passo.board.identify import Identification

from .cortex import Cortex

Values = dict[str, int | bytes]


def identified(chip: Cortex) -> Dictionary:
    """Asks a chip that has just been switched on who it is."""
    found = Identification()
    while found.dictionary is None:
        data, _ = found.poll(chip.cycles / chip.CORE_HZ)
        chip.received.extend(data)
        chip.run(0.0004)
        found.feed(bytes(chip.sent))
        chip.sent.clear()
        assert chip.cycles < chip.CORE_HZ, "no answer for a second"
    return found.dictionary


class Host:
    """Speaks to a chip that has just been switched on, and whose dictionary it knows."""

    def __init__(self, chip: Cortex, dictionary: Dictionary) -> None:
        self.chip, self.dictionary = chip, dictionary
        self._commands = _core.Formats(list(dictionary.commands))
        self._reports = _core.Formats(list(dictionary.reports))
        self._scanner = _core.FrameScanner()
        chip.run(0.001)
        ((self._sequence, payload),) = self._scanner.feed(self._heard())
        assert [name for name, _ in self._reports.decode(payload)] == ["starting"]

    def _heard(self) -> bytes:
        data = bytes(self.chip.sent)
        self.chip.sent.clear()
        return data

    def give(self, line: str) -> None:
        """Sends a command and waits for nothing."""
        payload = self._commands.encode(*self.dictionary.values(line))
        self.chip.received.extend(_core.make_frame(payload, self._sequence))
        self._sequence = (self._sequence + 1) % 16

    def send(self, *lines: str, seconds: float = 0.0005) -> dict[str, Values]:
        """Sends commands, a frame each; the last report of each name that comes back in time."""
        reports: dict[str, Values] = {}
        for line in lines:
            self.give(line)
            self.chip.run(seconds)
            for frame in self._scanner.feed(self._heard()):
                assert frame is not None and frame[0] == self._sequence
                reports |= dict(self._reports.decode(frame[1]))
        return reports
