"""Tables of the reference pages on imports."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.importing.table import path_of

if TYPE_CHECKING:
    from passo.config.importing.table import Fate, Group, Row, Table

_TITLES = {
    "built-in": ("{}s that Passo needs no key for", "in Passo"),
    "decide": ("{}s that you decide", "what to do"),
    "dropped": ("{}s that are not taken over", "what that means"),
}


def groups(table: Table, what: str, star: bool = False) -> str:
    """The options that become keys, with a table for each group. Names in options are in capitals,
    or a `*` each."""
    column = what if star else "option"
    parts = [f"\n## {what.title()}s that become keys of the machine file\n"]
    for group in table.groups.values():
        if group.of:
            note = f"\n{group.note[0].upper()}{group.note[1:]}.\n" if group.note else ""
            head = f"\n### {_escaped(group.of)}\n{note}\n| {column} | unit | key | note |\n"
            rows = "".join(_row(group, row, star) for row in group.rows)
            parts.append(f"{head}|---|---|---|---|\n{rows}")
    return "".join(parts)


def notes(table: Table, group: str, what: str, fate: Fate) -> str:
    """A table of the rows without a key that have this fate, in the order of their names."""
    title, column = _TITLES[fate]
    found = sorted((row.option, row.note) for row in table.groups[group].rows if row.fate == fate)
    rows = "".join(f"| {_escaped(option)} | {note} |\n" for option, note in found)
    head = f"| {what} | {column} |\n|---|---|\n"
    return f"\n## {title.format(what.title())}\n\n{head}{rows}"


def _row(group: Group, row: Row, star: bool) -> str:
    key = ".".join(path_of(group.to, row.key, _Capitals())) if row.key else row.fate or ""
    usual = f"without it {row.default}" if row.default not in (None, "") else ""
    note = "; ".join(part for part in (row.note, usual) if part)
    option = ", ".join(_capitals(row.option).split(" "))
    if star:
        written = re.sub(r"#?\{\w+\}", _star, row.option)
        option = ", ".join(dict.fromkeys(written.split(" ")))
    if row.when:
        note = f"with {row.when}" + (f"; {note}" if note else "")
    key = f"`{key}`" if row.key else f"*{key}*"
    return f"| {_escaped(option)} | {row.unit} | {key} | {note} |\n"


class _Capitals(dict[str, str]):
    def __missing__(self, name: str) -> str:
        return name.upper()


def _star(found: re.Match[str]) -> str:
    return "" if found[0].startswith("#") else "*"


def _capitals(text: str) -> str:
    return re.sub(r"\{(\w+)\}", lambda found: found[1].upper(), text)


def _escaped(text: str) -> str:
    return text.replace("*", r"\*")
