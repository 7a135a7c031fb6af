"""Which files are programs, by their names."""

from __future__ import annotations

from pathlib import PurePosixPath

PROGRAMS = (".gcode", ".g", ".gc", ".gco", ".nc", ".ngc", ".cnc", ".tap")
"""How the names of G-code files end."""


def is_program(name: str) -> bool:
    """The name is that of a G-code file."""
    return PurePosixPath(name.lower()).suffix in PROGRAMS
