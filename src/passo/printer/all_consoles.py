"""Answers for all consoles, to G-code that no console has sent."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.printer.wait_requests import without_effect

if TYPE_CHECKING:
    from passo.printer.state import State


class ToAllConsoles:
    """A reply, but for `fail`, that sends answers to all consoles."""

    def __init__(self, state: State) -> None:
        self._state = state
        self._noted: set[str] = set()

    def say(self, text: str) -> None:
        """Sends a line to all consoles."""
        self._state.tell(text)

    def note(self, about: str, text: str, *, again: bool = False) -> None:
        """Sends a line to all consoles, once for each `about`, or each time if `again`."""
        if again or about not in self._noted:
            self._noted.add(about)
            self._state.tell(f"echo:{text}")

    def no_part(self, code: str, why: str) -> None:
        """As a note."""
        self.note(code, without_effect(code, why))

    def with_ok(self, text: str) -> None:
        """Sends the text as a line, because there is no `ok`."""
        self._state.tell(text)

    def warming(self, text: str) -> None:
        """Does nothing, because consoles query temperatures with M105."""
