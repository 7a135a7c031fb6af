"""The texts that consoles receive from a printer: answers to a file's commands, and a greeting."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from passo.catalogue import CATALOGUE
from passo.console.session import Session
from passo.errors import InputError, Problem
from passo.printer.all_consoles import ToAllConsoles

if TYPE_CHECKING:
    from passo.printer.state import State


class FileReply(ToAllConsoles):
    """Sends the answers to a file's commands to all consoles."""

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
    unreported, state.unreported = state.unreported, []
    for text in unreported:
        session.say(text)
    if state.halted:
        session.say(f"echo:Printer halted: {state.why_halted}")
    if greeting := state.greeting():
        session.say(greeting)
