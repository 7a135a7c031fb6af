"""The keys of a machine file: their values, their sources, and their changes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Literal, cast

from msgspec import Struct

from passo.config.findings import key_text
from passo.config.key_settings import setting_of
from passo.config.machine_text import HIDDEN, is_secret
from passo.config.toml_lines import Path, key_lines

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_ABSENT = object()


class KeyValue(Struct):
    """A key with its value. `source` is `file` (then `line` is its line), `board` (the file of a
    board or sensor that the machine file names), or `default`. `setting` is the command with the
    word that also sets the value; it is empty for most keys. `setting_value` is the active value,
    and `setting_source` its source: `file`, `stored` (M500), or `command`."""

    key: str
    value: Any
    source: Literal["file", "board", "default"]
    line: int | None = None
    setting: str = ""
    setting_value: str = ""
    setting_source: str = ""


class KeyChange(Struct):
    """A key whose value differs; a value is null if the key is missing. `acts` is the time when the
    change takes effect: at once (`live`) or after a `restart`."""

    key: str
    before: Any
    after: Any
    acts: Literal["live", "restart"]


def key_values(machine: MachineConfig, text: str) -> list[KeyValue]:
    """All keys of a machine that was loaded from this text, in the order of the model. Secrets are
    not shown."""
    lines = key_lines(text)
    given = dict(leaves(machine.model_dump(mode="json", exclude_defaults=True)))
    found: list[KeyValue] = []
    for path, value in leaves(machine.model_dump(mode="json")):
        line = lines.get(path)
        source = "file" if line is not None else "board" if path in given else "default"
        found.append(KeyValue(key_text(path), _shown(path, value), source, line))
    return found


def key_changes(before: MachineConfig, after: MachineConfig) -> list[KeyChange]:
    """The keys whose values differ, without secrets."""
    old = dict(leaves(before.model_dump(mode="json")))
    new = dict(leaves(after.model_dump(mode="json")))
    found: list[KeyChange] = []
    for path in {**old, **new}:
        was, becomes = old.get(path, _ABSENT), new.get(path, _ABSENT)
        if was == becomes:
            continue
        shown = [None if value is _ABSENT else _shown(path, value) for value in (was, becomes)]
        key = key_text(path)
        live = setting_of(key) is not None and isinstance(becomes, int | float)
        found.append(KeyChange(key, shown[0], shown[1], "live" if live else "restart"))
    return found


def leaves(value: object, path: Path = ()) -> Iterator[tuple[Path, object]]:
    """Each value that is not a table, with its path."""
    if isinstance(value, Mapping):
        for key, inner in cast("Mapping[str, object]", value).items():
            yield from leaves(inner, (*path, key))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for index, inner in enumerate(cast("list[object]", value)):
            yield from leaves(inner, (*path, index))
    else:
        yield path, value


def _shown(path: Path, value: object) -> object:
    return HIDDEN.strip('"') if value is not None and is_secret(path[-1]) else value
