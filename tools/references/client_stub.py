"""The types of the Python client, made from the table of operations: `web/client.pyi`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap
from typing import Any, get_args, get_origin

import msgspec

from passo.web.answers import JSON
from passo.web.operation import Operation
from passo.web.operations import OPERATIONS

_HEAD = '''"""The Python client, made from the table of operations: make reference."""

{imports}

class RequestError(Exception):
    status: int
    fault: Fault
    def __init__(self, status: int, fault: Fault) -> None: ...

'''
_CLIENT = '''class {name}:
    """{text}"""

    def __init__(
        self, url: str = ..., *, key: str | None = None, timeout_s: float = ...
    ) -> None: ...
'''


def stub() -> str:
    """The text of the file."""
    groups: dict[str, list[Operation]] = {}
    for operation in OPERATIONS:
        if not operation.compatible:
            groups.setdefault(operation.group, []).append(operation)
    modules: set[str] = {"passo.web.answers"}
    classes: list[str] = []
    for prefix, define in (("", "def"), ("Async", "async def")):
        for group, operations in groups.items():
            lines = [f"class {prefix}{group.title()}:"]
            for operation in operations:
                lines += _method(operation, define, modules)
            classes.append("\n".join(lines))
    for name, text, prefix in (
        ("Client", "A printer that is served somewhere.", ""),
        ("AsyncClient", "As `Client`, with calls to await.", "Async"),
    ):
        lines = [_CLIENT.format(name=name, text=text)]
        for group in groups:
            lines += ["    @property", f"    def {group}(self) -> {prefix}{group.title()}: ..."]
        classes.append("\n".join(lines))
    imports = "\n".join(f"import {module}" for module in sorted(modules))
    head = _HEAD.format(imports=imports).replace("fault: Fault", "fault: passo.web.answers.Fault")
    return head + "\n\n".join(classes) + "\n"


def _method(operation: Operation, define: str, modules: set[str]) -> Iterator[str]:
    needed = [f"{n}: {_name(kind, modules)}" for n, kind in operation.parameters.items()]
    if operation.consumes != JSON:
        needed.append("data: bytes")
    other: list[str] = []
    for kind in (operation.body, operation.query):
        for field in msgspec.structs.fields(kind) if kind is not None else ():
            text = f"{field.encode_name}: {_name(field.type, modules)}"
            if field.required:
                needed.append(text)
            else:
                other.append(f"{text} = ...")
    answer = "bytes" if operation.produces != JSON else _name(operation.response, modules)
    yield f"    {define} {operation.verb}("
    yield from (f"        {text}," for text in ["self", *needed, *other])
    yield f"    ) -> {answer}:"
    yield from _docstring(operation.text)
    yield "        ..."


def _docstring(text: str) -> Sequence[str]:
    return wrap(f'"""{text}"""', 92, initial_indent=" " * 8, subsequent_indent=" " * 8)


def _name(kind: Any, modules: set[str]) -> str:
    """A type as written, without msgspec's constraints."""
    if hasattr(kind, "__metadata__"):
        return _name(get_args(kind)[0], modules)
    if kind is None or kind is type(None):
        return "None"
    if get_origin(kind) is None:
        if kind.__module__ == "builtins":
            return _builtin(kind.__name__, modules)
        modules.add(kind.__module__)
        return f"{kind.__module__}.{kind.__qualname__}"
    arguments = get_args(kind)
    origin: Any = get_origin(kind)
    if "Union" in str(origin):
        return " | ".join(_name(argument, modules) for argument in arguments)
    if "Literal" in str(origin):
        modules.add("typing")
        return f"typing.Literal[{', '.join(map(repr, arguments))}]"
    inner = ", ".join("..." if a is ... else _name(a, modules) for a in arguments)
    return f"{_builtin(origin.__name__, modules)}[{inner}]"


def _builtin(name: str, modules: set[str]) -> str:
    """A built-in type, even within a class that has a method of the same name."""
    if any(operation.verb == name for operation in OPERATIONS):
        modules.add("builtins")
        return f"builtins.{name}"
    return name
