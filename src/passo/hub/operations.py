"""The table of the hub's operations: its own, and those of accounts, which are the printer's."""

from __future__ import annotations

from passo.hub import endpoints
from passo.web.endpoints import accounts, session
from passo.web.operation import Operation, declared, declared_in

OPERATIONS: tuple[Operation, ...] = (
    *declared_in(session),
    *declared_in(accounts),
    *declared(endpoints),
)
