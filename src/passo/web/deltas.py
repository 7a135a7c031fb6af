"""Trees of plain values, as in JSON, and the changes between two of them."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any, TypeAlias, cast

import msgspec

Tree: TypeAlias = dict[str, Any]


def tree(value: object) -> Tree:
    """A dataclass as a tree: its fields by name, sets as sorted lists, and None for a number that
    is not finite, because JSON has no such numbers."""
    return cast("Tree", _plain(msgspec.to_builtins(value, order="sorted")))


def changes(before: Mapping[str, Any], now: Mapping[str, Any]) -> Tree:
    """The patch with which `merged` turns `before` into `now` (RFC 7386, JSON merge patch): changed
    keys with their new values, and None for removed keys. Lists change as a whole."""
    found: Tree = {key: None for key in before if key not in now}
    for key, value in now.items():
        old = before.get(key)
        if isinstance(value, dict) and isinstance(old, dict):
            if inner := changes(cast("Tree", old), cast("Tree", value)):
                found[key] = inner
        elif key not in before or value != old:
            found[key] = value
    return found


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in cast("Tree", value).items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in cast("list[Any]", value)]
    if isinstance(value, float) and not isfinite(value):
        return None
    return value
