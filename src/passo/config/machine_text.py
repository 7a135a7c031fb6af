"""A loaded machine as text without secrets, which users may publish."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

HIDDEN = '"(not shown)"'
_SECRET_KEY = re.compile(r"pass(word|phrase|wd|code)?$|secret|token|credential|api_?key|^uuid$")
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_USER_IN_URL = re.compile(r"(?<=://)[^/@\s]*@")


def is_secret(key: str | int) -> bool:
    """Whether the value of a key is secret, by the last part of its path."""
    return _SECRET_KEY.search(str(key).lower()) is not None


def machine_text(machine: MachineConfig) -> str:
    """A line of TOML, `key.key = value`, for each value that is not a default, including values
    from the files of boards and sensors. Passwords, tokens, users in URLs and the UUID are not
    shown."""
    values = machine.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
    _add_kinds(values, machine.model_dump(mode="json"))
    for name, axis in machine.axes.items():
        if axis.extruder:  # the model fills in limits, which the file may not have
            del cast("dict[str, dict[str, object]]", values["axes"])[name]["max_mm"]
    return "".join(f"{line}\n" for line in _lines(values, ()))


def _add_kinds(values: dict[str, object], whole: Mapping[str, object]) -> None:
    """Adds a default `kind` to each table, because it determines the keys of the table."""
    for key, value in values.items():
        if isinstance(value, dict):
            content = cast("dict[str, object]", value)
            of_whole = cast("Mapping[str, object]", whole[key])
            if "kind" in of_whole:
                content.setdefault("kind", of_whole["kind"])
            _add_kinds(content, of_whole)


def _lines(values: Mapping[str, object], path: tuple[str, ...]) -> Iterator[str]:
    for key, value in values.items():
        here = (*path, key)
        if is_secret(key) or not isinstance(value, dict):
            yield f"{'.'.join(map(toml_key, here))} = {shown_toml(here, value)}"
        else:
            yield from _lines(cast("dict[str, object]", value), here)


def shown_toml(path: tuple[str | int, ...], value: object) -> str:
    """The value of a key as TOML, without secrets."""
    return HIDDEN if is_secret(path[-1]) else _USER_IN_URL.sub("", toml_value(value))


def toml_key(key: str) -> str:
    """A part of a key as TOML: bare, or in quotes."""
    return key if _BARE_KEY.fullmatch(key) else json.dumps(key, ensure_ascii=False)


def toml_value(value: object) -> str:
    """A value as TOML; tables are inline."""
    if isinstance(value, list):
        return f"[{', '.join(toml_value(item) for item in cast('list[object]', value))}]"
    if isinstance(value, dict):
        content = cast("dict[str, object]", value)
        shown = (
            f"{toml_key(key)} = {HIDDEN if is_secret(key) else toml_value(item)}"
            for key, item in content.items()
        )
        return f"{{ {', '.join(shown)} }}" if content else "{}"
    if isinstance(value, float):
        return str(value)  # TOML supports inf and nan
    return json.dumps(value, ensure_ascii=False)
