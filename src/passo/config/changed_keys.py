"""Replaces values of a machine file by the path of their keys, before the file is checked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, cast

from passo.config.findings import Finding, path_of


def put_changes(data: dict[str, Any], changes: Mapping[str, object]) -> Iterator[Finding]:
    """Puts each value at its key, in the form of messages (`axes.x.speed_mm_s`,
    `tools[1].extruder`); missing tables are added. A key that leads through a value or beyond a
    list is a finding."""
    for key, value in changes.items():
        path = path_of(key)
        place: Any = data
        for part in path[:-1]:
            place = _below(place, part)
        if not path or not _put(place, path[-1], value):
            yield Finding("config.unknown-key", path or (key,), value)


def _below(place: Any, part: str | int) -> Any:
    """The table or list at a key or an index; None if there cannot be one."""
    if isinstance(place, dict) and isinstance(part, str):
        return cast("dict[str, Any]", place).setdefault(part, {})
    if isinstance(place, list) and isinstance(part, int):
        items = cast("list[Any]", place)
        return items[part] if part < len(items) else None
    return None


def _put(place: Any, part: str | int, value: object) -> bool:
    if isinstance(place, dict) and isinstance(part, str):
        cast("dict[str, Any]", place)[part] = value
        return True
    if isinstance(place, list) and isinstance(part, int):
        items = cast("list[Any]", place)
        if part < len(items):
            items[part] = value
            return True
    return False
