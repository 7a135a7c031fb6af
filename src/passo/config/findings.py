"""The findings of the checks of a machine file, without file and line."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from datetime import date, time
from math import isfinite
from typing import Any, cast

from passo.config.toml_lines import Path

_PART = re.compile(r"(?:^|\.)([^.\[\]]+)|\[(\d+)\]")


@dataclass(frozen=True, slots=True)
class Finding:
    """One problem. `path` is the path of the key; `limit` is the expected value, and `nearest` the
    allowed value that is nearest, if the value is a number beyond a bound. `owner` is the path of
    the key that already has the value; messages name its position too."""

    code: str
    path: Path
    value: object = None
    limit: str = ""
    hint: str = ""
    owner: Path | None = None
    nearest: float | None = None

    @property
    def key(self) -> str:
        """The path in the form of the machine file."""
        return key_text(self.path)


def key_text(path: Path) -> str:
    """A path in the form of the machine file: `tools[1].extruder`."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def path_of(key: str) -> Path:
    """The path of a key in the form of `key_text`."""
    return tuple(int(index) if index else name for name, index in _PART.findall(key))


class _Written(str):
    """A value in the form of the file: a text without its quotes."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


def as_written(value: object) -> object:
    """A value for messages and for JSON. A value with another form in JSON than in TOML becomes
    text."""
    if value is None:
        return _Written("missing")
    if isinstance(value, bool):
        return _Written(str(value).lower())
    if isinstance(value, date | time):
        return _Written(value.isoformat())
    if isinstance(value, float) and not isfinite(value):
        return _Written(value)
    if isinstance(value, list):
        return [as_written(item) for item in cast("list[object]", value)]
    if isinstance(value, Mapping):
        content = cast("Mapping[str, object]", value)
        return {key: as_written(item) for key, item in content.items()}
    return value


def did_you_mean(word: object, known: Iterable[str]) -> str:
    """A hint with the most similar known word, or with all known words if there are few; otherwise
    empty."""
    from difflib import get_close_matches

    names = sorted(known)
    folded = {name.casefold(): name for name in names}
    close = get_close_matches(str(word).casefold(), folded, n=1, cutoff=0.6)
    if close:
        return f"Did you mean {folded[close[0]]!r}?"
    return f"Known here: {', '.join(names)}" if 0 < len(names) <= 16 else ""


def table(data: object, *keys: str) -> Mapping[str, Any]:
    """The table at `keys`; empty if it is missing or not a table. The models report type errors,
    which must not hide other errors here."""
    for key in keys:
        data = cast("Mapping[str, Any]", data).get(key) if isinstance(data, Mapping) else None
    return cast("Mapping[str, Any]", data) if isinstance(data, Mapping) else {}


def tables(data: Mapping[str, Any], key: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Name and content of each table inside the table `key`."""
    for name, content in table(data, key).items():
        if isinstance(content, Mapping):
            yield name, cast("Mapping[str, Any]", content)


def parts_with_sensors(data: Mapping[str, Any]) -> list[tuple[str, str, Mapping[str, Any]]]:
    """The heaters and the sensors without a heater: section, name and content of each."""
    return [
        (part, name, content)
        for part in ("heaters", "sensors")
        for name, content in tables(data, part)
    ]


def array(data: Mapping[str, Any], key: str) -> list[object]:
    """The array at `key`, empty if it is missing or is not an array."""
    value = data.get(key)
    return cast("list[object]", value) if isinstance(value, list) else []


def number(content: Mapping[str, Any], key: str) -> float | None:
    """The number at `key`, None if it is missing or is not a finite number."""
    value = content.get(key)
    if not isinstance(value, int | float) or isinstance(value, bool):
        return None
    return value if isfinite(value) else None
