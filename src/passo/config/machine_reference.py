"""The reference page of the machine file, made from its models: each key with its unit, range,
default and help. The help of a key is the docstring after the field in its model."""

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

from passo.config.machine import MachineConfig
from passo.config.types import PATTERNS, PIN

_HEAD = """# Keys of the machine file

Made from the models in `src/passo/config/` and `src/passo/geometry/`
(`passo.config.machine_reference`). [How to write a machine file](../how-to/write-a-machine-file.md)
has an example of all of it; `passo machines i3` prints a shipped one, and `passo check FILE` names
everything that is wrong with a file.

An unknown key is an error. NAME is a name that you choose. *Required* keys must be given if their
table is; of a board with a `base`, only `base` is required.

A *pin* is a pin of the microcontroller (`PB4`), a name of the [board](boards.md) (`D10`), or a name
in `[board.pins]`. Before it stands `!` to invert it, `^` for a pull-up, and the name of a further
board (`tool:PA1`).
"""

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


class Table(NamedTuple):
    """A table of the machine file: its heading, its description, its keys."""

    heading: str
    text: str
    keys: list[Key]


def reference() -> str:
    """The page, in Markdown."""
    parts = [_HEAD]
    for heading, text, keys in tables():
        if heading == "`[boards.NAME]`":
            parts.append(f"## {heading}\n\nA further board. Its keys are those of `[board]`.\n")
        if heading.startswith("`[boards."):
            continue
        parts.append(f"## {heading}\n\n{text}\n")
        rows = [f"| `{k.name}` | {k.unit} | {k.range} | {k.default} | {k.help} |" for k in keys]
        parts.append("| key | unit | range | default | what it is |\n|---|---|---|---|---|")
        parts.append("\n".join(rows) + "\n")
    return "\n".join(parts)


def tables() -> Iterator[Table]:
    """All tables, each before those within it."""
    yield from _tables(MachineConfig, "")


def _tables(model: type[BaseModel], path: str) -> Iterator[Table]:
    keys = [
        key_of(model, name)
        for name, field in model.model_fields.items()
        if not (path == "" and models_of(field.annotation))
    ]
    kind = model.model_fields.get("kind")
    choice = f", kind = {_kinds(kind)}" if kind and path else ""
    heading = f"`{path}`{choice}" if path else "Top level"
    text = " ".join((model.__doc__ or "").split("\n\n")[0].split())
    yield Table(heading, text, keys)
    for name, field in model.model_fields.items():
        for inner in models_of(field.annotation):
            yield from _tables(inner, _path(path, name, field.annotation))


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
    kind, limits = _unwrapped(annotation)
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


def _unwrapped(annotation: Any) -> tuple[Any, dict[str, Any]]:
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
    kind, _ = _unwrapped(annotation)
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return [kind]
    inner = get_args(kind)[-1:] if get_origin(kind) is dict else _some(kind)
    return [m for part in inner if get_origin(kind) is not Literal for m in models_of(part)]


def _path(path: str, name: str, annotation: Any) -> str:
    kind, _ = _unwrapped(annotation)
    inside = path.strip("[]")
    full = f"{inside}.{name}" if inside else name
    if get_origin(kind) is list:
        return f"[[{full}]]"
    while get_origin(kind) is dict:
        full, (kind, _) = f"{full}.NAME", _unwrapped(get_args(kind)[1])
    return f"[{full}]"


def _kinds(field: FieldInfo) -> str:
    return " or ".join(f'`"{kind}"`' for kind in get_args(field.annotation))
