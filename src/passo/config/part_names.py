"""Names of parts and macros, which keep their case and are found in any case."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable


def part_name(name: str) -> str:
    """The name of a part in its own case, with _ in place of other characters than letters, digits,
    - and _."""
    return _plain(name).lstrip("-") or "part"


def _plain(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_-]+", "_", name)


def found_name(known: Iterable[str], written: str) -> str | None:
    """The known name that is written here. The same name wins; else the only one that differs in
    case alone; else the only one that differs in case and in the characters that names of parts do
    not have, such as blanks. None without such a name."""
    names = list(known)
    if written in names:
        return written
    alike: tuple[Callable[[str], str], ...] = (
        str.casefold,
        lambda name: _plain(name).casefold(),
    )
    for form in alike:
        wanted = form(written)
        same = [name for name in names if form(name) == wanted]
        if same:
            return same[0] if len(same) == 1 else None
    return None
