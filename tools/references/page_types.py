"""The types of the pages, in TypeScript, made from the descriptions of the interfaces:
`web-ui/src/api/schema.ts` of a printer, `web-ui/src/farm/schema.ts` of a farm."""

from __future__ import annotations

import json
from collections.abc import Sequence
from textwrap import wrap
from typing import Any, TypeAlias, cast

from passo.hub import operations as farm
from passo.web import operations as printer
from passo.web.openapi import description
from passo.web.operation import Operation

Tree: TypeAlias = dict[str, Any]
_HEAD = """/** The types of the API, made from its table of operations: make reference. Numbers that
 * are not finite, and what a merge patch has removed, are missing. */
"""
_NAMES = {
    "string": "string",
    "number": "number",
    "integer": "number",
    "boolean": "boolean",
    "null": "null",
}


def page_types() -> str:
    """The text of the file for the page of a printer."""
    return _types(printer.OPERATIONS)


def farm_types() -> str:
    """The text of the file for the page of a farm."""
    return _types(farm.OPERATIONS)


def _types(operations: Sequence[Operation]) -> str:
    schemas: dict[str, Tree] = description(operations)["components"]["schemas"]
    return _HEAD + "".join(f"\n{_declared(name, schemas[name])}" for name in sorted(schemas))


def _declared(name: str, schema: Tree) -> str:
    text = " ".join(schema.get("description", "").split())
    lines = wrap(text, 95) or [name]
    comment = "/** " + "\n * ".join(lines) + " */\n"
    if "enum" in schema:
        return f"{comment}export type {name} = {_type(schema)};\n"
    # A request may omit fields with a default; an answer has all fields, except those that are
    # null.
    request = schema.get("additionalProperties") is False
    required = schema.get("required", [])
    fields = "".join(
        f"  {field}{'?' if _nullable(kind) or (request and field not in required) else ''}: "
        f"{_type(kind)};\n"
        for field, kind in schema.get("properties", {}).items()
    )
    return f"{comment}export interface {name} {{\n{fields}}}\n"


def _nullable(schema: Tree) -> bool:
    return any(kind.get("type") == "null" for kind in schema.get("anyOf", []))


def _type(schema: Tree) -> str:
    if "$ref" in schema:
        return str(schema["$ref"]).rpartition("/")[2]
    if "enum" in schema:
        return " | ".join(json.dumps(value) for value in schema["enum"])
    if "anyOf" in schema:
        return " | ".join(_type(kind) for kind in schema["anyOf"])
    match schema.get("type"):
        case "array":
            if "prefixItems" in schema:
                return f"[{', '.join(_type(kind) for kind in schema['prefixItems'])}]"
            inner = _type(schema.get("items", {}))
            return f"({inner})[]" if " | " in inner else f"{inner}[]"
        case "object":
            values = schema.get("additionalProperties", {})
            return f"Record<string, {_type(cast('Tree', values) if values is not True else {})}>"
        case str() as name:
            return _NAMES[name]
        case _:
            return "unknown"
