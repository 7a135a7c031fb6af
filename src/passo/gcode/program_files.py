"""Recognises G-code files by the endings of their names."""

from __future__ import annotations

from pathlib import PurePosixPath

PROGRAMS = (".gcode", ".g", ".gc", ".gco", ".nc", ".ngc", ".cnc", ".tap")
"""Endings of the names of G-code files."""


def is_program(name: str) -> bool:
    """Whether the name is that of a G-code file."""
    return PurePosixPath(name.lower()).suffix in PROGRAMS
