"""The table of all operations for clients. Routes, checks of roles, the OpenAPI description, the
reference and the Python client are made from it."""

from __future__ import annotations

from passo.web import endpoints, slicers
from passo.web.operation import Operation, declared

OPERATIONS: tuple[Operation, ...] = (*declared(endpoints), *declared(slicers))
"""The operations for clients, one module for each subject. Each handler declares its row of the
table."""
