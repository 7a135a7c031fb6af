"""The subscription of a client to the printer's objects, and their changes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

Object: TypeAlias = dict[str, Any]
Wishes: TypeAlias = Mapping[str, Sequence[str] | None]  # fields of objects; None: all
Lookup: TypeAlias = Callable[[str], Object]  # an object by its name; empty if it does not exist


def picked(wishes: Wishes, lookup: Lookup) -> dict[str, Object]:
    """The requested fields. A field that does not exist is None, like an unknown value."""
    found: dict[str, Object] = {}
    for name, fields in wishes.items():
        values = lookup(name)
        found[name] = dict(values) if fields is None else {k: values.get(k) for k in fields}
    return found


class Subscription:
    """The subscription of one client. If it requests all fields of an object, these are the fields
    of the first answer; fields that appear later are never sent."""

    def __init__(self, wishes: Wishes, template: Mapping[str, Any]) -> None:
        self._wishes: dict[str, Sequence[str] | None] = dict(wishes)
        self.template = dict(template)
        self._sent: dict[str, Object] = {}

    @property
    def names(self) -> Sequence[str]:
        """The names of the subscribed objects."""
        return tuple(self._wishes)

    def first(self, lookup: Lookup) -> dict[str, Object]:
        """All requested fields. Call it once, before `changed`."""
        self._sent = picked(self._wishes, lookup)
        self._wishes = {name: tuple(values) for name, values in self._sent.items()}
        return self._sent

    def changed(self, lookup: Lookup) -> dict[str, Object]:
        """The fields whose values differ from those sent last, by object."""
        news: dict[str, Object] = {}
        now = picked(self._wishes, lookup)
        for name, values in now.items():
            before = self._sent[name]
            if fields := {k: v for k, v in values.items() if v != before[k]}:
                news[name] = fields
        self._sent = now
        return news
