"""A row of the table of operations, and the decorator with which a handler declares it."""

from __future__ import annotations

import re
from collections.abc import Awaitable, Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from inspect import getdoc, signature
from pkgutil import iter_modules
from types import ModuleType
from typing import Any, Literal, TypeAlias, get_args, get_origin, get_type_hints

from passo.web.answers import JSON, Answer
from passo.web.roles import Role

API = "/api/v1"
HEADER = "X-Passo-Request"  # a form of another web page cannot send this header
USER_HEADER = "X-Passo-User"  # the user of the program that sends the request
_MAX_BODY = 1 << 20  # bytes of a request in JSON
_PARAMETER = re.compile(r"\{(\w+)(?::\w+)?\}")

Method: TypeAlias = Literal["GET", "POST", "PUT", "PATCH", "DELETE"]


@dataclass(frozen=True, slots=True)
class Caller:
    """The caller of a request. `session` is the hash of the log-in, or empty. `key` is the hash of
    the API key, or empty. `address` is the caller's address in the form in which failed log-ins are
    counted (see `address_key`)."""

    name: str
    role: Role
    session: str = ""
    key: str = ""
    address: str = ""


Handler: TypeAlias = Callable[..., Awaitable[object]]


def _body_of(response: Any) -> Any:
    """The type of the body of an answer; None without a body."""
    if response is type(None):
        return None
    return get_args(response)[0] if get_origin(response) is Answer else response


@dataclass(frozen=True, slots=True)
class Operation:
    """A row of the table: an operation for clients. `name` is `group.verb`, as in the Python
    client. `body` and `query` are the types of the request, None without one; `response` is the
    type of an answer in JSON, None for 204 and for other content; `status` is the HTTP status of an
    answer in JSON. `errors` are the codes of the catalogue that this operation has in addition to
    the common ones. If the request is not JSON, the handler reads it and limits its size; if the
    answer is not JSON, the handler returns a `Response`. `fresh`: the password must have been
    entered within the last five minutes. `compatible`: the operation belongs to another printer's
    interface, and is not in the description.
    """

    name: str
    method: Method
    path: str
    role: Role
    handler: Handler
    body: Any
    query: Any
    response: Any
    parameters: dict[str, type]
    errors: tuple[str, ...] = ()
    consumes: str = JSON
    produces: str = JSON
    status: int = 200
    max_body: int = _MAX_BODY
    fresh: bool = False
    compatible: bool = False

    @property
    def group(self) -> str:
        """The noun: `heaters` of `heaters.set`."""
        return self.name.partition(".")[0]

    @property
    def verb(self) -> str:
        """`set` of `heaters.set`."""
        return self.name.partition(".")[2]

    @property
    def text(self) -> str:
        """Its description, in one paragraph."""
        return " ".join((getdoc(self.handler) or "").split())

    @property
    def template(self) -> str:
        """The path with only the names of its parameters in braces."""
        return _PARAMETER.sub(r"{\1}", self.path)

    @property
    def writes(self) -> bool:
        """Whether the operation changes something."""
        return self.method != "GET"


def operation(
    name: str,
    method: Method,
    path: str,
    role: Role,
    *,
    errors: tuple[str, ...] = (),
    consumes: str = JSON,
    produces: str = JSON,
    status: int = 200,
    max_body: int = _MAX_BODY,
    fresh: bool = False,
    root: str = API,
) -> Callable[[Handler], Operation]:
    """Declares a handler. The arguments of the handler are the call, the parameters of the path by
    name, and `body` and `query` if it has them. Its annotations are the types of request and
    answer; its docstring is the text in the reference. A `root` other than the API's marks another
    printer's interface."""

    def declare(handler: Handler) -> Operation:
        hints = get_type_hints(handler, include_extras=True)
        response = hints.pop("return")
        taken = list(signature(handler).parameters)[1:]
        given = _PARAMETER.findall(path)
        if [p for p in taken if p not in ("body", "query")] != given:
            raise TypeError(f"{name}: the handler takes {taken}, the path {path} gives {given}")
        return Operation(
            name=name,
            method=method,
            path=root + path,
            role=role,
            handler=handler,
            body=hints.get("body"),
            query=hints.get("query"),
            response=_body_of(response) if produces == JSON and root == API else None,
            parameters={parameter: hints[parameter] for parameter in given},
            errors=errors,
            consumes=consumes,
            produces=produces,
            status=status,
            max_body=max_body,
            fresh=fresh,
            compatible=root != API,
        )

    return declare


def declared(package: ModuleType) -> Iterator[Operation]:
    """The operations of the modules of a package, in the order of their names."""
    for found in sorted(iter_modules(package.__path__), key=lambda module: module.name):
        yield from declared_in(import_module(f"{package.__name__}.{found.name}"))


def declared_in(module: ModuleType) -> Iterator[Operation]:
    """The operations of a module, in the order of their declaration."""
    return (value for value in vars(module).values() if isinstance(value, Operation))
