"""The reference page for the conversion of Marlin's defines."""

from __future__ import annotations

from passo.config.importing.marlin.boards import BOARDS
from passo.config.importing.marlin.conversion import TABLE
from passo.config.importing.reference_rows import groups, notes

_HEAD = """# What becomes of Marlin's Configuration.h

Made from `src/passo/config/importing/marlin/table.toml`.
[How to import a file](../how-to/move-from-marlin.md).
`*` is an axis (X, Y, Z), a motor (X, Z2, E0), a heater (0, 1, BED, CHAMBER) or a number. Other
defines are named together in the report, or concern menus, texts and buffers.
"""
_BOARDS = """
## Boards

The numbers of Marlin 1.1 and older names of these boards are known too. A machine with another
board is simulated until `--board` names one with the same wiring.

| MOTHERBOARD | [board](boards.md) | variant |
|---|---|---|
"""


def reference() -> str:
    """The page, in Markdown."""
    return (
        _HEAD
        + groups(TABLE, "define", star=True)
        + notes(TABLE, "options", "define", "built-in")
        + notes(TABLE, "options", "define", "dropped")
        + _BOARDS
        + "".join(
            f"| {name} | {board.base} | {board.variant or ''} |\n"
            for name, board in sorted(BOARDS.items())
        )
    )
