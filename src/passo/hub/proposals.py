"""Printers in the local network that an administrator may add."""

from __future__ import annotations

from msgspec import Struct


class ProposedPrinter(Struct, frozen=True):
    """A printer that announces itself and is not in the farm."""

    id: str
    name: str
    url: str


class Proposals:
    """The printers that announce themselves. Nothing is added without an administrator."""

    def __init__(self) -> None:
        self._found: dict[str, ProposedPrinter] = {}

    def announced(self, printer: ProposedPrinter) -> None:
        """Called when a printer announces itself."""
        self._found[printer.id] = printer

    def withdrawn(self, id: str) -> None:
        """Called when a printer ends its announcement."""
        self._found.pop(id, None)

    def but(self, known: set[str]) -> list[ProposedPrinter]:
        """The printers that are not `known`, by name."""
        found = (one for one in self._found.values() if one.id not in known)
        return sorted(found, key=lambda one: (one.name, one.id))
