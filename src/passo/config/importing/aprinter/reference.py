"""The reference page on the import of APrinter's document."""

from __future__ import annotations

from passo.config.importing.aprinter.conversion import TABLE
from passo.config.importing.reference_rows import groups, notes

_HEAD = """# What becomes of APrinter's configuration

Made from `src/passo/config/importing/aprinter/table.toml`.
[How to import a file](../how-to/move-from-aprinter.md).
`control/PidP` is the value PidP below control. Words in capitals are names. An option that is
stored on the printer counts before the document.
"""


def reference() -> str:
    """The page, in Markdown."""
    return _HEAD + groups(TABLE, "value") + notes(TABLE, "values", "value", "decide")
