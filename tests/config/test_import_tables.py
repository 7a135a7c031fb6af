"""The tables of the importers: each row names a key that a machine file has."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from passo.config.importing import klipper
from passo.config.importing.table import Row, Table, table_of
from passo.config.machine_schema import schema

FOLDER = Path(klipper.__file__).parents[1]
FILES = sorted(FOLDER.glob("*/table.toml"))
SCHEMA = schema()


def rows(table: Table) -> Iterator[tuple[str, Row]]:
    for group in table.groups.values():
        yield from ((group.to, row) for row in group.rows)


def below(tree: dict[str, Any], name: str) -> Iterator[dict[str, Any]]:
    """The schemas of a key within the value of a schema; a `{name}` is any name."""
    if "$ref" in tree:
        yield from below(SCHEMA["$defs"][tree["$ref"].rpartition("/")[2]], name)
        return
    for one in (*tree.get("anyOf", ()), *tree.get("oneOf", ()), *tree.get("allOf", ())):
        yield from below(one, name)
    more = tree.get("additionalProperties")
    if name in tree.get("properties", {}):
        yield tree["properties"][name]
    elif isinstance(more, dict):
        yield more
    for pattern, one in tree.get("patternProperties", {}).items():
        if "{" in name or re.search(pattern, name):
            yield one


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.parent.name)
def test_each_row_names_a_key_of_the_machine_file(file: Path) -> None:
    wrong: list[str] = []
    for to, row in rows(table_of(file)):
        path = row.key[1:] if row.key.startswith(".") else f"{to}.{row.key}".strip(".")
        found = [SCHEMA]
        for name in path.split(".") if row.key else ():
            found = [one for tree in found for one in below(tree, name)]
        if not found:
            wrong.append(path)
    assert wrong == []


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.parent.name)
def test_each_row_has_a_key_or_a_note_for_the_owner(file: Path) -> None:
    table = rows(table_of(file))
    assert [row.option for _, row in table if not row.key and not row.note] == []
