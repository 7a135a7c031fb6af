"""The reference pages of the HTTP interfaces, made from their tables of operations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, cast

from msgspec.json import schema_components

from passo.hub import operations as farm
from passo.web import operations as printer
from passo.web.answers import JSON
from passo.web.openapi import PATH, statuses
from passo.web.operation import Operation

_HEAD = f"""# HTTP interface

Made from the table of operations (`passo.web.operations`). `passo serve` serves it at
`http://127.0.0.1:4000`; the same as an OpenAPI 3.1 description is at `{PATH}`. The Python client
`passo.Client` has each operation by its name: `client.heaters.set("hotend", 200)`.

Requests and answers are JSON. An error is
`{{"error": {{"code", "part", "message", "action", "values"}}, "others": []}}`, with a code of
[the catalogue](errors.md). Any operation answers

| status | if |
|---|---|
| 400 | the request is not as described here |
| 401 | it has no log-in and no key |
| 403 | the role is too low, or the request comes from another web page |
| 429 | there were too many attempts to log in |
| 500 | the program has a fault |
| 503 | the printer is halted |

| role | may |
|---|---|
| public | what needs no log-in |
| viewer | see all, change nothing |
| operator | print, move, heat, upload |
| admin | also change accounts, keys, the machine file and firmware |

## The feed

`/api/v1/feed` is a WebSocket (role viewer). Each message is a JSON object with a `type`:

| type | sent | fields |
|---|---|---|
| `status` | first | `version`, `status`: the whole status, as `status.get` |
| `changes` | at changes, at most 4 a second | `version`, `changes`: a merge patch (RFC 7386) |
| `event` | when something happens | `event`: `kind` and fields, as in [`passo.events`](python.md) |
| `line` | for each line of a console, if asked | `line`: `console`, `sender`, `received`, `text` |
| `answer` | when a script is done | `id`, `lines`, `error`: null, or as above |
| `build` | for each line of a build of firmware, if asked | `number`, `state`, `line` |
| `lost` | to a client that reads too slowly | `events`: how many events and lines were dropped |

A client may send

| message | effect |
|---|---|
| `{{"type": "script", "id": 1, "script": "G28"}}` | runs lines of G-code (role operator) |
| `{{"type": "listen", "console": true}}` | the lines of all consoles follow, or not any more |
| the same with `"builds": true` | and those of builds of firmware |

It closes with 1008 when the log-in ends. The connection ends without a code if the client does not
read for 5 s.

`/api/v1/summary/feed` is a WebSocket (role viewer) for pages over many printers. Each message is
the whole [Summary](#summary): at the start, at once when the state, the print, the fault or the
last print changes, and otherwise at most every 2 s. It ends in the same way.

## Headers

| header | of | meaning |
|---|---|---|
| `X-Api-Key` | a program | its key |
| `X-Passo-Request: 1` | a browser that is logged in | needed to change something |
| `X-Passo-User` | a program | the user for whom it acts: consoles and log show `KEY (USER)` |

A user's name beyond ASCII is UTF-8 with percent-encoding.
"""


_HUB_HEAD = f"""# HTTP interface of the hub

Made from the table of operations (`passo.hub.operations`). `passo hub` serves it at
`http://127.0.0.1:4100`; the same as an OpenAPI 3.1 description is at `{PATH}`. Requests, answers,
errors, roles, log-ins and keys are those of [a printer](http.md). An account that is limited to
tags sees and commands only printers with one of them; others do not exist for it.

## The feed

`/api/v1/feed` is a WebSocket (role viewer). Each message is a JSON object with a `type`:

| type | sent | fields |
|---|---|---|
| `farm` | first, and to a client that reads too slowly | `farm`: [Farm](#farm) |
| `changes` | at changes, at most once a second | the fields below |

| field of `changes` | content |
|---|---|
| `printers`, `jobs` | those that have changed, as a whole |
| `gone` | ids of printers and jobs that have been removed |
| `groups` | all power groups; null if none has changed |
| `queue_paused` | whether nothing starts |

The printers of one message have at most 80 kB together: those whose state has changed come first,
and those with new temperatures or progress follow in the next message. The feed closes with 1008
when the log-in ends or its limit changes.
"""


def reference() -> str:
    """The page of a printer, in Markdown."""
    return _HEAD + "\n".join(_lines(printer.OPERATIONS)) + "\n"


def hub_reference() -> str:
    """The page of the hub, in Markdown."""
    return _HUB_HEAD + "\n".join(_lines(farm.OPERATIONS)) + "\n"


def _lines(listed: Sequence[Operation]) -> Iterator[str]:
    groups: dict[str, list[Operation]] = {}
    for operation in listed:
        if not operation.compatible:
            groups.setdefault(operation.group, []).append(operation)
    kinds: list[Any] = []
    for group, operations in groups.items():
        yield f"\n## {group}\n"
        yield "| operation | role | request | answer | errors |\n|---|---|---|---|---|"
        for operation in operations:
            yield _row(operation, kinds)
        yield ""
        for operation in operations:
            yield f"- `{operation.name}`: {operation.text}"
    _, components = schema_components(kinds, ref_template="{name}")
    yield "\n## Types\n"
    yield "`?` after a name: it may be left out.\n"
    for name, schema in sorted(components.items()):
        yield f"### {name}\n"
        yield _type(schema)


def _row(operation: Operation, kinds: list[Any]) -> str:
    asked = [_named(kind, kinds) for kind in (operation.body, operation.query) if kind is not None]
    if operation.consumes != JSON:
        asked.append(f"`{operation.consumes}`")
    answer = _named(operation.response, kinds) if operation.response else "nothing (204)"
    if operation.produces != JSON:
        answer = f"`{operation.produces}`"
    role = f"{operation.role}, password" if operation.fresh else str(operation.role)
    codes = [code for found in statuses(operation).values() for code in found]
    own = [f"`{code}`" for code in codes if code in operation.errors]
    how = f"`{operation.name}` `{operation.method} {operation.template}`"
    return f"| {how} | {role} | {', '.join(asked)} | {answer} | {', '.join(own)} |"


def _named(kind: Any, kinds: list[Any]) -> str:
    kinds.append(kind)
    (schema,), _ = schema_components([kind], ref_template="{name}")
    return _kind(schema)


def _kind(schema: dict[str, Any]) -> str:
    if "$ref" in schema:
        name: str = schema["$ref"]
        return f"[{name}](#{name.lower()})"
    if "anyOf" in schema:
        return " or ".join(_kind(one) for one in cast("list[Any]", schema["anyOf"]))
    if "enum" in schema:
        return " or ".join(f"`{value}`" for value in cast("list[Any]", schema["enum"]))
    kind: str = schema.get("type", "any")
    if kind == "array":
        if "prefixItems" in schema:
            return f"[{', '.join(_kind(one) for one in cast('list[Any]', schema['prefixItems']))}]"
        return f"list of {_kind(schema.get('items', {}))}"
    if kind == "object" and isinstance(schema.get("additionalProperties"), dict):
        return f"{_kind(schema['additionalProperties'])} by name"
    limits = [f"{word} {schema[key]:g}" for key, word in _LIMITS.items() if key in schema]
    return " ".join([kind, *limits])


_LIMITS = {
    "minimum": "from",
    "exclusiveMinimum": "above",
    "maximum": "to",
    "exclusiveMaximum": "below",
    "minLength": "of at least",
    "maxLength": "of at most",
}


def _type(schema: dict[str, Any]) -> str:
    text = " ".join(str(schema.get("description", "")).split())
    lines = [text, ""] if text else []
    if "properties" not in schema:
        return "\n".join([*lines, _kind(schema), ""])
    lines += ["| field | type |", "|---|---|"]
    required = schema.get("required", [])
    for name, kind in schema["properties"].items():
        mark = "" if name in required else "?"
        lines.append(f"| `{name}{mark}` | {_kind(kind)} |")
    return "\n".join([*lines, ""])
