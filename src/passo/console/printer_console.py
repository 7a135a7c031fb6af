"""The texts that consoles receive from a printer: answers to a file's commands, and a greeting."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from passo.catalogue import CATALOGUE
from passo.console.session import Session
from passo.errors import InputError, Problem
from passo.printer.wait_requests import without_effect

if TYPE_CHECKING:
    from passo.printer.state import State


class AllConsoles:
    """Sends the answers to a file's commands to all consoles."""

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
        """Sends the text as a line, because a file receives no `ok`."""
        self._state.tell(text)

    def warming(self, text: str) -> None:
        """Does nothing, because consoles query temperatures with M105 during a print."""

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """Reports a refused command, with the problem that a print without consoles has for it."""
        # Do not raise CommandError, which would be reported a second time.
        same = next((p for p in problems if str(p) == text and not p.file), None)
        if same is None:
            raise InputError.of("job.failed", value=text.rstrip("."))
        go_on = CATALOGUE["job.failed"].action
        raise InputError([replace(same, hint=f"{same.advice}. {go_on}")])


def welcome(name: str, state: State, session: Session) -> None:
    """Sends the greeting of a console that opens. `name` is that of the machine. The first console
    also receives the problems since the start."""
    session.say("start")
    session.say(f"echo:Passo, {name}")
    unheard, state.unheard = state.unheard, []
    for text in unheard:
        session.say(text)
    if state.halted:
        session.say(f"echo:Printer halted: {state.why_halted}")
    if greeting := state.greeting():
        session.say(greeting)
