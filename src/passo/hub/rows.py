"""The rows of SQLite that hold a struct: one column for each field, lists and objects in JSON."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, TypeVar, get_origin

import msgspec
from msgspec import Struct

from passo.hub.run_state import RunState
from passo.hub.views import Loaded

_T = TypeVar("_T", bound=Struct)


def _reader(kind: Any) -> Callable[[Any], Any] | None:
    """What makes a value of a column into the value of a field; None: nothing is needed."""
    if kind is Loaded or get_origin(kind) is tuple:
        return msgspec.json.Decoder(kind).decode
    return kind if kind is bool or kind is RunState else None


def cell(value: Any) -> Any:
    """The value of a field as SQLite stores it."""
    if isinstance(value, tuple | list | Struct):
        return msgspec.json.encode(value).decode()
    return value.value if isinstance(value, RunState) else value


class Table(Generic[_T]):
    """The table of one kind of struct. `key` are the fields that name a row."""

    def __init__(self, kind: type[_T], name: str, *key: str) -> None:
        self.kind, self.name, self.key = kind, name, key
        fields = msgspec.structs.fields(kind)
        self.columns = ", ".join(field.name for field in fields)
        self._readers = [_reader(field.type) for field in fields]
        marks = ", ".join("?" * len(fields))
        self.insert = f"insert into {name} ({self.columns}) values ({marks})"
        self.where = " and ".join(f"{field} = ?" for field in key)

    def row(self, cells: tuple[Any, ...]) -> _T:
        """The struct of a row, with the columns in the order of `columns`."""
        values = (
            read(value) if read is not None and value is not None else value
            for read, value in zip(self._readers, cells, strict=True)
        )
        return self.kind(*values)

    def cells(self, row: Struct) -> list[Any]:
        """The values of the columns."""
        return [cell(value) for value in msgspec.structs.astuple(row)]

    def key_of(self, row: Struct) -> list[Any]:
        """The values of the key."""
        return [getattr(row, field) for field in self.key]
