"""Counts the commands that a print without consoles skips, with one warning for each code."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum

_MAX_CODES = 1000  # maximum of separately counted codes

Counts = Mapping[str, tuple[int, int]]
"""The first line and the count of each."""


class SkippedCommand(Enum):
    """The reason why a command was skipped, as a sentence."""

    UNKNOWN = "{} is unknown and was skipped"
    NOT_BUILT = "{} does nothing here and was skipped"
    SERVED = "{} is for a printer that is served and was skipped"
    LEVELLING = "{}: levelling was skipped"
    USER = "{} waits for the user; without a console it took no time"
    STOP = "{} stops a print; the plan continues after it"
    REPEAT = "{} in the main program repeats it on other machines; here it ends the program"
    ENDLESS = "{} COUNT=0 repeats its lines until SDCARD_LOOP_DESIST; here they ran once"
    TOOL = "tool {} does not exist and was ignored"
    PARAMETER = "{} has no effect"
    REFUSED = "{}"


class SkippedCommands:
    """Counts of one program. Not thread-safe."""

    def __init__(self) -> None:
        self._counts: dict[SkippedCommand, dict[str, tuple[int, int]]] = {
            why: {} for why in SkippedCommand
        }
        self.cut_at = 0  # the line in which a truncated file ended

    def count(self, why: SkippedCommand, what: str, line: int) -> None:
        """Counts a skipped command."""
        counts = self._counts[why]
        if what not in counts and len(counts) >= _MAX_CODES:
            what = "any other code"
        first, times = counts.get(what, (line, 0))
        counts[what] = (first, times + 1)

    def times(self, why: SkippedCommand) -> int:
        """The number of commands that were skipped for this reason."""
        return sum(times for _, times in self._counts[why].values())

    def warnings(self, file: str, others: Counts) -> list[str]:
        """One sentence for each skipped code, those of `others`, and one for a truncated file."""
        reasons = [(why.value, counts) for why, counts in self._counts.items()] + [("{}", others)]
        cut = f"{file}:{self.cut_at}: the file ends in the middle of a line, it may be cut short"
        return [
            f"{file}:{line}: {sentence.format(what)} ({times} {'time' if times == 1 else 'times'})"
            for sentence, counts in reasons
            for what, (line, times) in counts.items()
        ] + ([cut] if self.cut_at else [])
