"""Keys of the machine file, described from its models: unit, range, default and help. The help of a
key is the docstring after the field in its model."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterator
from functools import cache
from types import UnionType
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from passo.config.types import PATTERNS, PIN

# Endings of keys and their units; the first match is used.
_UNITS = (
    ("_mm_s2", "mm/s²"),
    ("_deg_s2", "°/s²"),
    ("_mm_s", "mm/s"),
    ("_deg_s", "°/s"),
    ("steps_per_mm", "1/mm"),
    ("steps_per_degree", "1/°"),
    ("_per_ma", "1/mA"),
    ("_per_k", "1/K"),
    ("cycles_per_step", "cycles"),
    ("cycles_per_command", "cycles"),
    ("bytes_s", "bytes/s"),
    ("_mm", "mm"),
    ("_s", "s"),
    ("_c", "°C"),
    ("_hz", "Hz"),
    ("_us", "µs"),
    ("_ohm", "Ω"),
    ("_ppm", "1e-6"),
    ("_deg", "°"),
    ("_a", "A"),
    ("_k", "K"),
    ("_v", "V"),
    ("_w", "W"),
    ("baud", "baud"),
)
_TABLES = {dict: "tables by name", list: "list of tables"}
_IN_UNIT = re.compile(r", in (mm(?:/s)?(?: or degrees(?:/s)?)?|degrees|steps|commands|s)\b\.?")


class Key(NamedTuple):
    """A key of a table, in the form for the page."""

    name: str
    unit: str
    range: str
    default: str
    help: str


def key_of(model: type[BaseModel], name: str) -> Key:
    """A key of a model, in Markdown. Raises KeyError if the model does not have it."""
    field, text = model.model_fields[name], field_help(model)[name]
    return Key(name, unit_of(name, text), _range(field), _default(field), _text(text))


@cache
def field_help(model: type[BaseModel]) -> dict[str, str]:
    """The help of each field of a model. KeyError names a field that has none."""
    found: dict[str, str] = {}
    for owner in reversed(model.__mro__):
        if issubclass(owner, BaseModel) and owner is not BaseModel:
            (tree,) = ast.parse(inspect.getsource(owner)).body
            assert isinstance(tree, ast.ClassDef)
            found |= _texts_after_fields(tree)
    lacking = [name for name in model.model_fields if name not in found]
    if lacking:
        raise KeyError(f"{model.__name__}: no help for {', '.join(lacking)}")
    return found


def _texts_after_fields(tree: ast.ClassDef) -> Iterator[tuple[str, str]]:
    for field, text in zip(tree.body, tree.body[1:], strict=False):
        if not (isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)):
            continue
        if isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant):
            yield field.target.id, " ".join(str(text.value.value).split())


def unit_of(name: str, text: str) -> str:
    """The unit of a key, from its name and its help; empty for a number without a unit."""
    if found := _IN_UNIT.search(text):
        return found[1]
    return next((unit for ending, unit in _UNITS if name.endswith(ending)), "")


def _text(text: str) -> str:
    return re.sub(_IN_UNIT.pattern + "$", ".", text).replace("|", "\\|")


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "*required*"
    value = field.default
    if value is None or field.default_factory is not None or isinstance(value, dict | list):
        return f"`{value}`" if isinstance(value, list) and value else "–"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    return f'`"{value}"`' if isinstance(value, str) else _number(value)


def _range(field: FieldInfo) -> str:
    own = {key: value for item in field.metadata for key, value in _limits(item).items()}
    return _range_of(field.annotation, own)


def _range_of(annotation: Any, own: dict[str, Any]) -> str:
    kind, limits = unwrapped(annotation)
    limits |= own
    if models_of(kind):
        return _TABLES.get(get_origin(kind), "table")
    if get_origin(kind) is Literal:
        return ", ".join(f'`"{v}"`' if isinstance(v, str) else f"{v}" for v in get_args(kind))
    if get_origin(kind) is list:
        length = limits.get("min_length")
        exact = length is not None and length == limits.get("max_length")
        inner = _range_of(get_args(kind)[0], {})
        return f"list of {length}: {inner}" if exact else f"list: {inner}"
    if get_origin(kind) is dict:
        return f"by name: {_range_of(get_args(kind)[1], {})}"
    if kind is bool:
        return "`true`, `false`"
    if kind is Any:
        return "value"
    if kind is str:
        pattern = limits.get("pattern")
        return "pin" if pattern == PIN else PATTERNS.get(str(pattern), "text")
    between = _between(limits)
    return between if kind is not int else f"whole, {between}".removesuffix(", number")


def _between(limits: dict[str, Any]) -> str:
    low = limits.get("ge"), limits.get("gt")
    high = limits.get("le"), limits.get("lt")
    least = f"above {_number(low[1])}" if low[0] is None else _number(low[0])
    most = f"below {_number(high[1])}" if high[0] is None else _number(high[0])
    if low != (None, None) and high != (None, None):
        return f"{least} to {most}"
    if low != (None, None):
        return least if low[0] is None else f"at least {least}"
    return "number"


def _number(value: Any) -> str:
    return "" if value is None else f"{value:.10g}"


def unwrapped(annotation: Any) -> tuple[Any, dict[str, Any]]:
    """The type without Optional and Annotated, and the limits of both."""
    limits: dict[str, Any] = {}
    while True:
        origin = get_origin(annotation)
        if origin is Annotated:
            annotation, *metadata = get_args(annotation)
            for item in metadata:
                limits |= _limits(item)
        elif origin in (Union, UnionType) and len(_some(annotation)) == 1:
            (annotation,) = _some(annotation)
        else:
            return annotation, limits


def _limits(item: Any) -> dict[str, Any]:
    if isinstance(item, FieldInfo):
        return {key: value for part in item.metadata for key, value in _limits(part).items()}
    names = ("ge", "gt", "le", "lt", "min_length", "max_length", "pattern")
    return {name: getattr(item, name) for name in names if getattr(item, name, None) is not None}


def _some(annotation: Any) -> list[Any]:
    return [part for part in get_args(annotation) if part is not type(None)]


def models_of(annotation: Any) -> list[type[BaseModel]]:
    """The models of the tables within a field."""
    kind, _ = unwrapped(annotation)
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return [kind]
    inner = get_args(kind)[-1:] if get_origin(kind) is dict else _some(kind)
    return [m for part in inner if get_origin(kind) is not Literal for m in models_of(part)]
