"""Facts about a key of a machine file: its description, its value on a machine, and the source of
the value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

from pydantic import BaseModel

from passo.config.findings import did_you_mean, key_text, path_of
from passo.config.machine import MachineConfig
from passo.config.machine_keys import Key, key_of, models_of
from passo.config.machine_text import shown_toml
from passo.errors import ConfigError

if TYPE_CHECKING:
    from passo.config.load import Loaded
    from passo.config.toml_lines import Path


@dataclass(frozen=True, slots=True)
class KeyFacts:
    """A key in the form of the machine file, its description, its value as TOML (None without one),
    and the file and line that set the value (None for a default)."""

    key: str
    described: Key
    value: str | None
    place: str | None


@dataclass(frozen=True, slots=True)
class _Place:
    """A place in a machine: its path, its value, the possible models of a table there, and the key
    of the place."""

    path: Path
    value: object
    models: list[type[BaseModel]]
    key: Key | None = None

    def inner(self, part: str | int) -> _Place:
        """The place of a key, a name or an index within this place. Raises KeyError if a machine
        file cannot have it."""
        path = (*self.path, part)
        if isinstance(self.value, BaseModel) or (self.value is None and self.models):
            models = self.models if self.value is None else [type(self.value)]
            for model in models:
                if part in model.model_fields:
                    value = getattr(self.value, str(part), None)
                    below = models_of(model.model_fields[str(part)].annotation)
                    return _Place(path, value, below, key_of(model, str(part)))
            raise KeyError(part)
        if self.value in ({}, []) and self.models:  # the machine does not have this part
            return _Place(path, None, self.models, self.key)
        return _Place(path, cast("Any", self.value)[part], self.models, self.key)

    def names(self) -> list[str | int]:
        """The possible keys, names or indices within this place; empty for a value."""
        if isinstance(self.value, BaseModel):
            return [*type(self.value).model_fields]
        if self.value is None:
            return [name for model in self.models for name in model.model_fields]
        value = cast("Mapping[str, object] | list[object] | float | str", self.value)
        if isinstance(value, Mapping):
            return [*value]
        return [*range(len(value))] if isinstance(value, list) else []


def key_facts(loaded: Loaded, key: str) -> Iterator[KeyFacts]:
    """The facts of a key, or of each key in a table. Raises ConfigError if no machine file has the
    key, or if the machine has no part of that name."""
    place = _Place((), loaded.machine, [MachineConfig])
    for part in path_of(key):
        try:
            place = place.inner(part)
        except (KeyError, IndexError, TypeError):
            known = [str(one) for one in place.names()]
            hint = did_you_mean(part, known)
            raise ConfigError.of(
                "config.unknown-key", loaded.origins.file, key=key, hint=hint
            ) from None
    yield from _facts(loaded, place)


def _facts(loaded: Loaded, place: _Place) -> Iterator[KeyFacts]:
    if place.models or place.key is None:
        for name in place.names():
            yield from _facts(loaded, place.inner(name))
        return
    value = None if place.value is None else shown_toml(place.path, place.value)
    yield KeyFacts(key_text(place.path), place.key, value, loaded.origins.place(place.path))
