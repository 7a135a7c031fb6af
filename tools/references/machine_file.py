"""The reference page of the machine file: each table with its keys."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from passo.config.machine import MachineConfig
from passo.config.machine_keys import Key, key_of, models_of, unwrapped

_HEAD = """# Keys of the machine file

Made from the models in `src/passo/config/` and `src/passo/geometry/` by
`tools/references/machine_file.py`. [How to write a machine file](../how-to/write-a-machine-file.md)
has an example of all of it; `passo machines i3` prints a shipped one, and `passo check FILE` names
everything that is wrong with a file.

An unknown key is an error. NAME is a name that you choose. *Required* keys must be given if their
table is; of a board with a `base`, only `base` is required.

A *pin* is a pin of the microcontroller (`PB4`), a name of the [board](boards.md) (`D10`), or a name
in `[board.pins]`. Before it stands `!` to invert it, `^` for a pull-up, and the name of a further
board (`tool:PA1`).
"""


class Table(NamedTuple):
    """A table of the machine file: its heading, its description, its keys."""

    heading: str
    text: str
    keys: list[Key]


def reference() -> str:
    """The page, in Markdown."""
    parts = [_HEAD]
    for heading, text, keys in tables():
        if heading == "`[boards.NAME]`":
            parts.append(f"## {heading}\n\nA further board. Its keys are those of `[board]`.\n")
        if heading.startswith("`[boards."):
            continue
        parts.append(f"## {heading}\n\n{text}\n")
        parts.append(rows_of(keys) + "\n")
    return "\n".join(parts)


def tables() -> Iterator[Table]:
    """All tables of the machine file, each before those within it."""
    yield from tables_of(MachineConfig)


def rows_of(keys: list[Key]) -> str:
    """The keys of a table, as a table of Markdown."""
    rows = [f"| `{k.name}` | {k.unit} | {k.range} | {k.default} | {k.help} |" for k in keys]
    return "\n".join(
        ["| key | unit | range | default | what it is |\n|---|---|---|---|---|", *rows]
    )


def tables_of(model: type[BaseModel], path: str = "") -> Iterator[Table]:
    """All tables of the files of a model, each before those within it."""
    keys = [
        key_of(model, name)
        for name, field in model.model_fields.items()
        if not (path == "" and models_of(field.annotation))
    ]
    kind = model.model_fields.get("kind")
    choice = f", kind = {_kinds(kind)}" if kind and path else ""
    heading = f"`{path}`{choice}" if path else "Top level"
    text = " ".join((model.__doc__ or "").split("\n\n")[0].split())
    yield Table(heading, text, keys)
    for name, field in model.model_fields.items():
        for inner in models_of(field.annotation):
            yield from tables_of(inner, _path(path, name, field.annotation))


def _path(path: str, name: str, annotation: Any) -> str:
    kind, _ = unwrapped(annotation)
    inside = path.strip("[]")
    full = f"{inside}.{name}" if inside else name
    if get_origin(kind) is list:
        return f"[[{full}]]"
    while get_origin(kind) is dict:
        full, (kind, _) = f"{full}.NAME", unwrapped(get_args(kind)[1])
    return f"[{full}]"


def _kinds(field: FieldInfo) -> str:
    return " or ".join(f'`"{kind}"`' for kind in get_args(field.annotation))
