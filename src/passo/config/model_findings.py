"""Converts pydantic's errors to findings with texts and hints of the catalogue."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from passo.config.findings import Finding, did_you_mean
from passo.config.machine import MachineConfig
from passo.config.toml_lines import Path
from passo.config.types import PATTERNS

_EXPECTED: dict[str, Callable[[dict[str, Any]], str]] = {
    "float_type": lambda _: "a number",
    "int_type": lambda _: "a whole number",
    "bool_type": lambda _: "true or false",
    "string_type": lambda _: "a text in quotes",
    "list_type": lambda _: "a list in brackets",
    "dict_type": lambda _: "a table",
    "model_type": lambda _: "a table",
    "model_attributes_type": lambda _: "a table",
    "finite_number": lambda _: "a finite number",
    "greater_than": lambda ctx: f"a number greater than {ctx['gt']:.12g}",
    "greater_than_equal": lambda ctx: f"a number of at least {ctx['ge']:.12g}",
    "less_than": lambda ctx: f"a number less than {ctx['lt']:.12g}",
    "less_than_equal": lambda ctx: f"a number of at most {ctx['le']:.12g}",
    "literal_error": lambda ctx: f"one of {ctx['expected']}",
    "string_pattern_mismatch": lambda ctx: PATTERNS[ctx["pattern"]],
    "value_error": lambda ctx: str(ctx["error"]),
    "too_short": lambda ctx: f"at least {ctx['min_length']} elements",
    "too_long": lambda ctx: f"at most {ctx['max_length']} elements",
}

_QUOTED = re.compile(r"'([^']*)'")


def _members(place: Any) -> list[Any]:
    """The allowed models at a place, or the place itself."""
    place = get_args(place)[0] if get_origin(place) is Annotated else place
    if get_origin(place) in (Union, UnionType):
        return [member for member in get_args(place) if member is not NoneType]
    return [place]


def _kinds(place: Any) -> dict[str, Any]:
    """The models by `kind`, if a table may be one of several; else empty."""
    members = _members(place)
    if len(members) < 2 or not all(_is_model(member) for member in members):
        return {}
    return {
        kind: member
        for member in members
        for kind in get_args(member.model_fields["kind"].annotation)
    }


def _one(place: Any) -> Any:
    """The type of an optional place, or the place itself."""
    members = _members(place)
    return members[0] if len(members) == 1 else place


def _is_model(place: Any) -> bool:
    return isinstance(place, type) and issubclass(place, BaseModel)


def _below(place: Any, part: str | int) -> Any:
    """The type at a key or an index of a place; None if it is unknown."""
    (member, *others) = _members(place)
    if others:
        return None
    if _is_model(member):
        field = member.model_fields.get(str(part))
        return field.annotation if field else None
    return get_args(member)[-1] if get_origin(member) in (dict, list) else None


def _place(path: Path, root: type[BaseModel]) -> tuple[Path, Any]:
    """The path in the file and its type. In pydantic's path, a table that may be one of several
    models has its kind after the key."""
    place: Any = root
    written: list[str | int] = []
    for part in path:
        kinds = _kinds(place)
        if kinds:
            place = kinds.get(str(part))
        else:
            written.append(part)
            place = _below(place, part)
    return tuple(written), place


def _missing(model: Any, key: str) -> str:
    """The expected value of a missing key."""
    place = _one(model.model_fields[key].annotation) if _is_model(model) else None
    if get_origin(place) is Literal:
        return f"one of {', '.join(map(str, get_args(place)))}"
    if key == "pin" or key.endswith("_pin"):
        return "a pin in quotes"
    words: dict[Any, str] = {
        float: "a number",
        int: "a whole number",
        str: "a text in quotes",
        list: "a list in brackets",
    }
    return words.get(get_origin(place) or place, "a table")


def expected(error: ErrorDetails) -> str:
    """The expected value, for an error of pydantic."""
    words = _EXPECTED.get(error["type"])
    return words(error.get("ctx", {})) if words is not None else error["msg"]


def _hint_of(key: str, known: Iterable[str], model: Any) -> str:
    """The hint for an unknown key: the closest key, or all keys that its table may have."""
    hint = did_you_mean(key, known)
    if hint.startswith("Did") or not known:
        return hint
    if model is not MachineConfig:  # other tables have few keys
        return f"Known here: {', '.join(sorted(known))}"
    tables = [name for name in known if not _is_plain(MachineConfig.model_fields[name].annotation)]
    return f"Known tables: {', '.join(f'[{name}]' for name in sorted(tables))}"


def _is_plain(place: Any) -> bool:
    """Whether the value at a place is a text or a number."""
    return _one(place) is str or get_origin(_one(place)) is Literal


def _finding(error: ErrorDetails, root: type[BaseModel]) -> Finding:
    kind, context, value = error["type"], error.get("ctx", {}), error["input"]
    model, key = _one(_place(error["loc"][:-1], root)[1]), str(error["loc"][-1])
    path, place = _place(error["loc"], root)
    if kind == "extra_forbidden":
        known = model.model_fields if _is_model(model) else ()
        return Finding("config.unknown-key", path, value, "", _hint_of(key, known, model))
    if kind == "missing":
        return Finding("config.missing-key", path, None, _missing(model, key))
    if kind in ("union_tag_not_found", "union_tag_invalid"):
        kinds = _kinds(place)
        limit = f"one of {', '.join(kinds)}"
        if kind == "union_tag_not_found":
            return Finding("config.missing-key", (*path, "kind"), None, limit)
        tag = context["tag"]
        return Finding("config.value", (*path, "kind"), tag, limit, did_you_mean(tag, kinds))
    hint = (
        did_you_mean(value, _QUOTED.findall(context["expected"])) if kind == "literal_error" else ""
    )
    path = path[:-1] if key == "[key]" else path
    nearest = context.get("ge", context.get("le"))
    return Finding("config.value", path, value, expected(error), hint, nearest=nearest)


def model_findings(
    error: ValidationError, root: type[BaseModel] = MachineConfig
) -> Iterator[Finding]:
    """One finding for each error of the models; `root` is the model of the whole file."""
    for detail in error.errors(include_url=False):
        # If a default depends on wrong keys, only those keys are reported.
        if detail["type"] != "default_factory_not_called":
            yield _finding(detail, root)
