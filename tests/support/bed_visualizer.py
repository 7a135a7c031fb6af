"""Bed Visualizer, the plugin of OctoPrint that draws the bed, as a reader of a printer's reply.

The plugin is on no package index, so its rules are written down here, with the traps in them: it
reads each line by its form alone, and knows no command.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

# A height may be in brackets, as the one below the nozzle of Marlin's UBL.
_HEIGHT = r"\[?\s?\+?-?\d+\.\d+\]?\s*,?"
_MISSING = r"(?:nan|NAN|=======)\s?,?"
_ROW = re.compile(rf"(?:\d+\s|\|\s*|\s*\[\s+|{_HEIGHT}|{_MISSING})+(?:\s+\],?)?")
# Old Marlin and Repetier report each point on a line that begins like this.
_POINT = re.compile(r"(?:Bed|Llit|G33).+")
_ANEW = re.compile(r"(?:Mesh )?Bed Level (?:Correction Matrix|data):|Subdivided with CATMULL ROM")


def drawn(lines: Iterable[str]) -> list[list[float]]:
    """The heights that the plugin draws, mm, the first row in front. It takes each line that may be
    a row of numbers, drops the rows before some headings, and ends at the first "ok" after a
    row."""
    rows: list[list[float]] = []
    for line in map(str.strip, lines):
        if "ok" in line:
            if rows:
                break
        elif _ANEW.match(line):
            rows = []
        elif _ROW.fullmatch(line) or _POINT.fullmatch(line):
            heights = [float(number) for number in re.findall(r"[+-]?\d+\.\d+", line)]
            rows += [heights] if heights else []
    return rows
