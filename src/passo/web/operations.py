"""The one table of operations: all that clients may ask for. Routes, the checks of roles, the
description for OpenAPI, the reference and the Python client follow it."""

from __future__ import annotations

from types import ModuleType

from passo.web.endpoints import (
    console,
    emergency,
    fans,
    heaters,
    history,
    job,
    machine,
    status,
)
from passo.web.operation import Operation


def _declared(module: ModuleType) -> list[Operation]:
    return [value for value in vars(module).values() if isinstance(value, Operation)]


_MODULES = (status, machine, emergency, console, job, heaters, fans, history)
OPERATIONS: tuple[Operation, ...] = tuple(
    operation for module in _MODULES for operation in _declared(module)
)
