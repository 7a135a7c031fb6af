"""Parameters of a request, checked as Klipper checks them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, cast

from passo.web.klippy.subscriptions import Wishes


class RequestError(Exception):
    """A request has failed; the client shows the text."""


class Arguments:
    """The parameters of one request. All methods raise RequestError."""

    def __init__(self, params: Mapping[str, Any]) -> None:
        self._params = params

    def text(self, name: str) -> str:
        """The value of a text parameter."""
        value = self._of(name)
        if not isinstance(value, str):
            raise _wrong_type(name)
        return value

    def template(self) -> dict[str, Any]:
        """The template of the messages of a subscription; empty if none is given."""
        return self._mapping("response_template", {})

    def wishes(self) -> Wishes:
        """The requested fields by the name of the object; None means all fields."""
        objects = self._mapping("objects")
        for fields in objects.values():
            if fields is not None and not _is_texts(fields):
                raise _wrong_type("objects")
        return objects

    def _of(self, name: str) -> Any:
        if name not in self._params:
            raise RequestError(f"Missing Argument [{name}]")
        return self._params[name]

    def _mapping(self, name: str, default: dict[str, Any] | None = None) -> dict[str, Any]:
        value = self._of(name) if default is None else self._params.get(name, default)
        if not isinstance(value, dict):
            raise _wrong_type(name)
        return cast("dict[str, Any]", value)


def _is_texts(value: object) -> bool:
    return isinstance(value, list) and all(
        isinstance(item, str) for item in cast("list[object]", value)
    )


def _wrong_type(name: str) -> RequestError:
    return RequestError(f"Invalid Argument Type [{name}]")
