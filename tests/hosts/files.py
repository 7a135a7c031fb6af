"""A file to print in which every move counts."""

from __future__ import annotations

import lzma
import re
from dataclasses import dataclass
from pathlib import Path

GEAR = Path(__file__).parents[1] / "data" / "gear_arcs.gcode.xz"
POCKET = GEAR.with_name("cnc_pocket.gcode.xz")
_START = "G28\nM140 S60\nM104 S215\nM190 S60\nM109 S215\nG90\nG1 X{0:.3f} Y{1:.3f} Z{2:.3f} F9000\n"
_END = "G90\nM104 S0\nM140 S0\nM107\nM400\n"


@dataclass(frozen=True)
class Program:
    """A G-code file and where it ends: x, y, z in mm and e in mm of filament."""

    path: Path
    lines: int
    end: dict[str, float]

    @property
    def text(self) -> str:
        """What the file holds."""
        return self.path.read_text()


def gear(path: Path, moves: int) -> Program:
    """Writes the first layers of the gear, with arcs, all moves relative: a line that is lost or
    carried out twice moves the end."""
    at = {"X": 125.0, "Y": 105.0, "Z": 0.2, "E": 0.0}
    lines = [_START.format(at["X"], at["Y"], at["Z"]), "G91\nM83\nG92 E0\n"]
    written = 0
    printing = False
    for raw in lzma.decompress(GEAR.read_bytes()).decode().splitlines():
        line = raw.partition(";")[0].strip()
        printing = printing or raw.startswith(";LAYER_CHANGE")
        if not printing or not re.match(r"G[0123]\b", line):
            continue
        words = dict(re.findall(r"([A-Z])([-\d.]+)", line))
        kept = [f"G{words['G']}"]
        for letter in "XYZ":
            if letter in words:
                kept.append(f"{letter}{float(words[letter]) - at[letter]:.3f}")
                at[letter] = float(words[letter])
        at["E"] += float(words.get("E", 0))
        kept += [f"{letter}{words[letter]}" for letter in "EIJF" if letter in words]
        lines.append(" ".join(kept) + "\n")
        written += 1
        if written == moves:
            break
    path.write_text("".join(lines) + _END)
    count = path.read_text().count("\n")
    return Program(path, count, {letter.lower(): value for letter, value in at.items()})


def pocket(path: Path) -> Program:
    """Writes a whole file: a program of a router, with tools, arcs, comments in parentheses."""
    path.write_bytes(lzma.decompress(POCKET.read_bytes()))
    count = path.read_text().count("\n")
    return Program(path, count, {"x": 0.0, "y": 0.0, "z": 20.0})
