"""The reference page on the import of a printer.cfg."""

from __future__ import annotations

from passo.config.importing.klipper.conversion import TABLE
from passo.config.importing.reference_rows import groups, notes

_HEAD = """# What becomes of a printer.cfg

Made from `src/passo/config/importing/klipper/table.toml`.
[How to import a file](../how-to/move-from-klipper.md).
A section that is in none of these tables is reported as *Passo does not have this part*. Words
in capitals are names.
"""


def reference() -> str:
    """The page, in Markdown."""
    return (
        _HEAD
        + groups(TABLE, "section")
        + notes(TABLE, "sections", "section", "built-in")
        + notes(TABLE, "sections", "section", "dropped")
        + notes(TABLE, "options", "option", "dropped")
        + notes(TABLE, "includes", "missing file", "built-in")
    )
