"""Turns pydantic's errors into findings: our words, our hints, every one of them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from passo.config.base import PATTERNS
from passo.config.findings import Finding, did_you_mean
from passo.config.kinds import KINDS
from passo.config.lines import Path
from passo.config.machine import MachineConfig

_EXPECTED: dict[str, Callable[[dict[str, Any]], str]] = {
    "float_type": lambda _: "a number",
    "int_type": lambda _: "a whole number",
    "bool_type": lambda _: "true or false",
    "string_type": lambda _: "a text in quotes",
    "list_type": lambda _: "a list in brackets",
    "dict_type": lambda _: "a table",
    "model_type": lambda _: "a table",
    "finite_number": lambda _: "a finite number",
    "greater_than": lambda ctx: f"a number greater than {ctx['gt']:.12g}",
    "greater_than_equal": lambda ctx: f"a number of at least {ctx['ge']:.12g}",
    "less_than": lambda ctx: f"a number less than {ctx['lt']:.12g}",
    "less_than_equal": lambda ctx: f"a number of at most {ctx['le']:.12g}",
    "literal_error": lambda ctx: f"one of {ctx['expected']}",
    "string_pattern_mismatch": lambda ctx: PATTERNS[ctx["pattern"]],
    "too_short": lambda ctx: f"at least {ctx['min_length']} elements",
    "too_long": lambda ctx: f"at most {ctx['max_length']} elements",
}

_QUOTED = re.compile(r"'([^']*)'")


def _models_below(annotation: Any) -> Iterator[type[BaseModel]]:
    """Models that an annotation may hold, through dicts, lists, unions and Annotated."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in get_args(annotation):
        yield from _models_below(argument)


def _model_at(path: Path) -> type[BaseModel] | None:
    """The model of the table at `path`; None where no model can be told."""
    if path[:1] == ("geometry",):  # pydantic puts the kind behind it
        return KINDS.get(str(path[1])) if len(path) > 1 else None
    model: type[BaseModel] = MachineConfig
    for part in path:
        field = model.model_fields.get(str(part))
        if field is not None:
            model = next(_models_below(field.annotation), model)
    return model


def _missing(model: type[BaseModel] | None, key: str) -> str:
    """What the missing key should hold."""
    annotation = model.model_fields[key].annotation if model else None
    words = {float: "a number", int: "a whole number", str: "a text in quotes"}
    return words.get(annotation, "a table") if isinstance(annotation, type) else "a table"


def _finding(error: ErrorDetails) -> Finding:
    path: Path = error["loc"]
    kind, context, value = error["type"], error.get("ctx", {}), error["input"]
    model, key = _model_at(path[:-1]), str(path[-1])
    if path[0] == "geometry":
        path = (path[0], *path[2:])
    if kind == "extra_forbidden":
        hint = did_you_mean(key, model.model_fields if model else ())
        return Finding("config.unknown-key", path, value, "", hint)
    if kind == "missing":
        return Finding("config.missing-key", path, None, _missing(model, key))
    if kind == "union_tag_not_found":
        return Finding("config.missing-key", (*path, "kind"), None, f"one of {', '.join(KINDS)}")
    if kind == "union_tag_invalid":
        kinds, tag = ", ".join(KINDS), context["tag"]
        hint = did_you_mean(tag, KINDS)
        return Finding("config.value", (*path, "kind"), tag, f"one of {kinds}", hint)
    hint = (
        did_you_mean(value, _QUOTED.findall(context["expected"])) if kind == "literal_error" else ""
    )
    expected = _EXPECTED.get(kind)
    limit = expected(context) if expected is not None else error["msg"]
    return Finding("config.value", path[:-1] if key == "[key]" else path, value, limit, hint)


def model_findings(error: ValidationError) -> Iterator[Finding]:
    """One finding for each error of the models."""
    for detail in error.errors(include_url=False):
        yield _finding(detail)
