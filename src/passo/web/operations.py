"""The table of all operations for clients. Routes, checks of roles, the OpenAPI description, the
reference and the Python client are made from it."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

from passo.web import endpoints, slicers
from passo.web.operation import Operation


def _declared(package: ModuleType) -> Iterator[Operation]:
    """The operations of the modules of a package, in the order of their names."""
    for found in sorted(iter_modules(package.__path__), key=lambda module: module.name):
        module = import_module(f"{package.__name__}.{found.name}")
        yield from (value for value in vars(module).values() if isinstance(value, Operation))


OPERATIONS: tuple[Operation, ...] = (*_declared(endpoints), *_declared(slicers))
"""The operations for clients, one module for each subject. Each handler declares its row of the
table."""
