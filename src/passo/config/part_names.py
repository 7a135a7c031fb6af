"""Names of parts and macros, which keep their case and are found in any case."""

from __future__ import annotations

from collections.abc import Iterable


def found_name(known: Iterable[str], written: str) -> str | None:
    """The known name that is written here. The same case wins; else the only name that differs in
    case alone. None without such a name."""
    names = list(known)
    if written in names:
        return written
    folded = written.casefold()
    same = [name for name in names if name.casefold() == folded]
    return same[0] if len(same) == 1 else None
