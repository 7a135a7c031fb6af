"""The table of all operations for clients. Routes, checks of roles, the OpenAPI description, the
reference and the Python client are made from it."""

from __future__ import annotations

from types import ModuleType

from passo.web.endpoints import (
    accounts,
    calibration,
    console,
    emergency,
    explain,
    fans,
    faults,
    files,
    firmware,
    heaters,
    history,
    job,
    logs,
    machine,
    machine_file,
    metrics,
    motion,
    queue,
    session,
    settings,
    simulation,
    status,
    tuning,
)
from passo.web.operation import Operation
from passo.web.slicers import moonraker, octoprint, prusalink, rrf


def _declared(module: ModuleType) -> list[Operation]:
    return [value for value in vars(module).values() if isinstance(value, Operation)]


_MODULES = (
    *(
        status,
        faults,
        machine,
        machine_file,
        firmware,
        emergency,
        job,
        queue,
        console,
        heaters,
        fans,
    ),
    *(
        motion,
        tuning,
        settings,
        calibration,
        simulation,
        files,
        history,
        explain,
        logs,
        session,
        accounts,
        metrics,
    ),
    *(octoprint, prusalink, moonraker, rrf),
)
OPERATIONS: tuple[Operation, ...] = tuple(
    operation for module in _MODULES for operation in _declared(module)
)
