"""The reference page of all commands, made from the dialect table."""

from __future__ import annotations

from passo.gcode.dialect import TABLE, Kind

_HEAD = """# Commands

Made from the dialect table (`passo.gcode.reference`). Letters may be lower case, blanks between
words may be missing, `G01` is `G1`. Numbers are decimal, without exponent: `X1E5` is X1 and E5. A
line may hold several commands.

Which words belong to a move: after G0 and G1 a `T` whole number that names a tool of the machine,
and an `M` whole number, begin a command of their own; other `T` (seconds) and, on machines with
such a laser, `L` and `M` belong to the move. Words that stand before the first command of a line
belong to it (`S12000 M3`), unless they name an axis or F: then the line is a move in the way of
the one before. A `T` word at the start of a line is a command (`T1 M6`).

Anything that is not listed is skipped with one warning.
"""
_TITLES = {
    Kind.MOTION: "Motion state",
    Kind.PRINTER: "Printer",
    Kind.PERSON: "Waiting for a person (no time in a print without one)",
    Kind.QUIET: "Understood, without effect",
}


def reference() -> str:
    """The page as Markdown."""
    parts = [_HEAD]
    for kind, title in _TITLES.items():
        parts.append(f"## {title}\n\n| command | parameters | |\n|---|---|---|")
        parts += [f"| {r.code} | {r.parameters} | {r.text} |" for r in TABLE if r.kind is kind]
        parts.append("")
    return "\n".join(parts)
