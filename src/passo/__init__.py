"""Passo: a 3-D printer control system. G-code in, exact step times out."""

from __future__ import annotations

import logging
from importlib import import_module
from typing import TYPE_CHECKING, Any

from passo.gcode import registry
from passo.version import __version__

if TYPE_CHECKING:
    from passo.errors import CommandError, ConfigError, InputError, MachineError, PassoError
    from passo.library import lab
    from passo.library.machine import Machine
    from passo.library.printer import Printer, run
    from passo.printer.status import Status
    from passo.study.batch import batch
    from passo.web.client import AsyncClient, Client, RequestError

__all__ = [
    "AsyncClient",
    "Client",
    "CommandError",
    "ConfigError",
    "InputError",
    "Machine",
    "MachineError",
    "PassoError",
    "Printer",
    "RequestError",
    "Status",
    "__version__",
    "batch",
    "lab",
    "run",
]

_ERRORS = ("CommandError", "ConfigError", "InputError", "MachineError", "PassoError")
_MODULES = dict.fromkeys(_ERRORS, "errors") | {
    "AsyncClient": "web.client",
    "Client": "web.client",
    "Machine": "library.machine",
    "Printer": "library.printer",
    "RequestError": "web.client",
    "Status": "printer.status",
    "batch": "study.batch",
    "run": "library.printer",
}


# If a program sets up no log handler, warnings do not appear on standard error.
logging.getLogger(__name__).addHandler(logging.NullHandler())


# The modules that declare commands are in layers above the registry, so they are imported by name
# here.
registry.load_with(lambda: import_module("passo.library.command_modules"))


def __getattr__(name: str) -> Any:
    """Loads a name of the library at its first use, so that the command line starts quickly."""
    if name == "lab":
        return import_module("passo.library.lab")
    if name in _MODULES:
        return getattr(import_module(f"passo.{_MODULES[name]}"), name)
    raise AttributeError(f"module 'passo' has no attribute {name!r}")
