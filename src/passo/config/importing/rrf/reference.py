"""The reference page on the import of a config.g."""

from __future__ import annotations

from passo.config.importing.reference_rows import groups, notes
from passo.config.importing.rrf.imported import TABLE

_HEAD = """# What becomes of RepRapFirmware's config.g

Made from `src/passo/config/importing/rrf/table.toml`.
`M203/X` is the word X of M203, and `M308/S1/P` the word P of M308 S1. Words in capitals are names.
The machine is simulated until you have checked its pins.
"""


def reference() -> str:
    """The page, in Markdown."""
    return (
        _HEAD
        + groups(TABLE, "command")
        + notes(TABLE, "commands", "command", "built-in")
        + notes(TABLE, "commands", "command", "dropped")
        + notes(TABLE, "commands", "command", "decide")
    )
