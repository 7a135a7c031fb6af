"""The description of the interface, in OpenAPI 3.1."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from http import HTTPStatus
from typing import TYPE_CHECKING, Any, TypeAlias

import msgspec
from msgspec.json import schema_components
from starlette.responses import Response
from starlette.routing import Route

from passo.version import __version__
from passo.web.answers import JSON, Refusal, status_of
from passo.web.operation import API, Operation
from passo.web.roles import Role

if TYPE_CHECKING:
    from starlette.requests import Request

Tree: TypeAlias = dict[str, Any]
_REFERENCE = "#/components/schemas/{name}"


def description(operations: Sequence[Operation], title: str = "Passo") -> Tree:
    """The content of `/api/v1/openapi.json`."""
    listed = [operation for operation in operations if not operation.compatible]
    kinds = [kind for o in listed for kind in (o.body, o.response, o.query) if kind is not None]
    kinds += [kind for o in listed for kind in o.parameters.values()]
    kinds.append(Refusal)
    schemas, components = schema_components(kinds, ref_template=_REFERENCE)
    schema_of = {_key(kind): schema for kind, schema in zip(kinds, schemas, strict=True)}
    paths: dict[str, Tree] = {}
    for operation in listed:
        row = _row(operation, schema_of, components)
        paths.setdefault(operation.template, {})[operation.method.lower()] = row
    for name in {_name(schema_of[_key(o.query)]) for o in listed if o.query is not None}:
        if _REFERENCE.format(name=name) not in msgspec.json.encode(paths).decode():
            del components[name]  # its fields are listed as parameters
    return {
        "openapi": "3.1.0",
        "info": {"title": title, "version": __version__, "license": {"name": "Apache-2.0"}},
        "paths": paths,
        "components": {
            "schemas": components,
            "securitySchemes": {
                "key": {"type": "apiKey", "in": "header", "name": "X-Api-Key"},
                "session": {"type": "apiKey", "in": "cookie", "name": "passo-session"},
            },
        },
    }


def statuses(operation: Operation) -> dict[int, list[str]]:
    """The codes of the possible errors of an operation, by HTTP status."""
    codes = ["web.host", "web.program", *operation.errors]
    if operation.role > Role.PUBLIC:
        codes += ["web.log-in", "web.role", "web.too-many"]
    if operation.writes:
        codes.append("web.origin")
    if operation.body is not None or operation.query is not None or operation.parameters:
        codes.append("web.invalid")
    if operation.body is not None:
        codes += ["web.malformed", "web.media-type", "web.slow", "web.too-large"]
    if operation.parameters:
        codes.append("web.not-found")
    if operation.fresh:
        codes.append("web.password")
    found: dict[int, list[str]] = {}
    for code in sorted(set(codes)):
        found.setdefault(status_of(code), []).append(code)
    return found


def _key(kind: Any) -> str:
    return repr(kind)


def _row(operation: Operation, schema_of: dict[str, Tree], components: Tree) -> Tree:
    summary, _, rest = operation.text.partition(". ")
    row: Tree = {
        "operationId": operation.name,
        "tags": [operation.group],
        "summary": summary.removesuffix("."),
        "x-role": str(operation.role),
        "responses": _responses(operation, schema_of),
    }
    if rest:
        row["description"] = operation.text
    parameters = [
        {"name": name, "in": "path", "required": True, "schema": schema_of[_key(kind)]}
        for name, kind in operation.parameters.items()
    ]
    if operation.query is not None:
        parameters += _query(schema_of[_key(operation.query)], components)
    if parameters:
        row["parameters"] = parameters
    if operation.body is not None:
        content = {operation.consumes: {"schema": schema_of[_key(operation.body)]}}
        row["requestBody"] = {"required": True, "content": content}
    elif operation.consumes != JSON:
        schema = {"type": "string", "format": "binary"}
        row["requestBody"] = {
            "required": True,
            "content": {operation.consumes: {"schema": schema}},
        }
    if operation.role > Role.PUBLIC:
        row["security"] = [{"key": []}, {"session": []}]
    return row


def _query(schema: Tree, components: Tree) -> list[Tree]:
    """The fields of a query type, as parameters."""
    name = _name(schema)
    described = components[name]
    required = described.get("required", [])
    return [
        {"name": field, "in": "query", "required": field in required, "schema": kind}
        for field, kind in described["properties"].items()
    ]


def _name(schema: Tree) -> str:
    """The name of the component to which a schema refers."""
    return str(schema["$ref"]).rpartition("/")[2]


def _responses(operation: Operation, schema_of: dict[str, Tree]) -> Tree:
    found: Tree = {}
    if operation.produces != JSON:
        schema = {"type": "string", "format": "binary"}
        found["200"] = {
            "description": "The content",
            "content": {operation.produces: {"schema": schema}},
        }
    elif operation.response is None:
        found["204"] = {"description": "Done"}
    else:
        content = {JSON: {"schema": schema_of[_key(operation.response)]}}
        found[str(operation.status)] = {"description": "The answer", "content": content}
    for status, codes in statuses(operation).items():
        content = {JSON: {"schema": schema_of[_key(Refusal)]}}
        text = f"{HTTPStatus(status).phrase}: {', '.join(codes)}"
        found[str(status)] = {"description": text, "content": content}
    return found


def route(operations: Sequence[Operation], title: str = "Passo") -> Route:
    """The route at which a server describes itself. The description is made when it is asked for,
    because few do."""

    async def answer(_: Request) -> Response:
        described = await asyncio.to_thread(encoded, operations, title)
        return Response(described, media_type=JSON)

    return Route(PATH, answer)


def encoded(operations: Sequence[Operation], title: str = "Passo") -> bytes:
    """The description as JSON."""
    return msgspec.json.format(msgspec.json.encode(description(operations, title)), indent=1)


PATH = f"{API}/openapi.json"
