"""What slicers write in their files about material, nozzle, time and filament."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

_PART = 1 << 18  # bytes at both ends of a file that are searched
_UNITS = {"d": 86400.0, "h": 3600.0, "m": 60.0, "s": 1.0}
# PrusaSlicer, SuperSlicer, OrcaSlicer and Bambu Studio; ideaMaker; Cura has no material.
_MATERIALS = re.compile(r"^; ?(?:filament_type ?= ?|Filament Type ?#\d+: ?)(.+)$", re.MULTILINE)
_NOZZLE = re.compile(
    r"^; ?(?:nozzle_diameter ?= ?|Nozzle Diameter ?#\d+: ?|  extruderDiameter,)([\d.]+)",
    re.MULTILINE,
)
_SECONDS = re.compile(r"^;(?:TIME:|Print Time: ?)(\d+(?:\.\d+)?)", re.MULTILINE)
_TIME = re.compile(
    r"^;.*?(?:estimated printing time(?: \(normal mode\))? ?= ?|total estimated time: ?"
    r"|Build time: ?)([\d dhms]+)",
    re.MULTILINE | re.IGNORECASE,
)
_MM = re.compile(
    r"^; ?(?:(?:total )?filament used \[mm\] ?= ?|Material#\d+ Used: ?|   Filament length: ?)"
    r"([\d., ]+)",
    re.MULTILINE,
)
_METRES = re.compile(r"^;Filament used: ?([\d.m, ]+)", re.MULTILINE)  # Cura
_NUMBER = re.compile(r"\d+(?:\.\d+)?")


@dataclass(frozen=True, slots=True)
class SlicerFacts:
    """The facts in a file; empty or None where it has none. Materials are in the order of the
    tools."""

    materials: tuple[str, ...] = ()
    nozzle_mm: float | None = None
    print_s: float | None = None
    filament_mm: float | None = None


def read_facts(path: Path) -> SlicerFacts:
    """The facts in a file. Raises OSError."""
    with path.open("rb") as file:
        size = file.seek(0, 2)
        file.seek(0)
        head = file.read(_PART)
        file.seek(max(size - _PART, len(head)))
        return facts_in((head + b"\n" + file.read()).decode("utf-8", "replace"))


def facts_in(text: str) -> SlicerFacts:
    """The facts in the comments of a text."""
    nozzle = _NOZZLE.search(text)
    return SlicerFacts(
        _materials(text), float(nozzle[1]) if nozzle else None, _print_s(text), _filament_mm(text)
    )


def _materials(text: str) -> tuple[str, ...]:
    found = [part.strip(' "\r') for line in _MATERIALS.findall(text) for part in line.split(";")]
    return tuple(part for part in found if part)


def _print_s(text: str) -> float | None:
    if (seconds := _SECONDS.search(text)) is not None:
        return float(seconds[1])
    if (found := _TIME.search(text)) is None:
        return None
    parts = re.findall(r"(\d+) ?([dhms])", found[1])
    return sum(int(count) * _UNITS[unit] for count, unit in parts) or None


def _filament_mm(text: str) -> float | None:
    if (metres := _METRES.search(text)) is not None:
        return sum(map(float, _NUMBER.findall(metres[1]))) * 1000
    if (found := _MM.search(text)) is None:
        return None
    return sum(map(float, _NUMBER.findall(found[1])))
