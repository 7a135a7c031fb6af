"""Delayed G-code of the machine file, which runs after a time."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING

from passo.config.part_names import found_name
from passo.errors import CommandError, PassoError, Problem
from passo.gcode.command import Command
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.wait_requests import Reply, Stopped, without_effect

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.lifetime import Lifetime
    from passo.printer.state import State

_log = logging.getLogger(__name__)
_MAX_S = 1e6


class _ToAllConsoles:
    """A reply that sends the answers to delayed G-code to all consoles."""

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
        """Does nothing: consoles query temperatures themselves."""

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """Reports a refused command."""
        problem = problems[0] if problems else None
        self._state.announce(_log, logging.WARNING, text, problem)


class DelayedGcode:
    """The delayed G-code of one printer. Each entry waits for the motion lock like a console; a
    halted printer runs none. Create it within a running event loop."""

    def __init__(self, control: Control, lifetime: Lifetime) -> None:
        self._control = control
        self._reply = _ToAllConsoles(control.state)
        self._due: dict[str, asyncio.TimerHandle] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        for name, delayed in control.rig.machine.delayed_gcode.items():
            self._set(name, delayed.initial_duration_s)
        lifetime.at_end(self._close)

    @command(
        "UPDATE_DELAYED_GCODE",
        Subject.MACROS,
        When.PLANNED,
        "ID DURATION(s)",
        "Carries out the delayed G-code of this name after this time; with 0 not at all.",
        kind=Kind.SERVED,
        bare=None,
    )
    def _update(self, command: Command, _: Reply) -> None:
        words = command.pairs()
        for key in ("ID", "DURATION"):
            if key not in words:
                raise CommandError.of("input.missing-word", axis=command.code, value=key)
        known = self._control.rig.machine.delayed_gcode
        name = found_name(known, words["ID"])
        if name is None:
            listed = ", ".join(known) or "none"
            raise CommandError.of("macro.no-delay", axis=words["ID"], value=listed)
        try:
            seconds = float(words["DURATION"])
        except ValueError:
            raise CommandError.of("input.number", value=f"DURATION={words['DURATION']}") from None
        if not (isfinite(seconds) and 0 <= seconds <= _MAX_S):
            raise CommandError.bad_value("DURATION", seconds, f"0 to {_MAX_S:g} s")
        self._set(name, seconds)

    def _set(self, name: str, seconds: float) -> None:
        """Schedules an entry after `seconds`, instead of its earlier time; 0 cancels it."""
        if (due := self._due.pop(name, None)) is not None:
            due.cancel()
        if seconds > 0:
            loop = asyncio.get_running_loop()
            self._due[name] = loop.call_later(seconds, self._start, name)

    def _start(self, name: str) -> None:
        del self._due[name]
        task = asyncio.get_running_loop().create_task(self._carry_out(name))
        self._tasks.add(task)  # the event loop has only a weak reference
        task.add_done_callback(self._tasks.discard)

    async def _carry_out(self, name: str) -> None:
        control = self._control
        await control.motion_lock.acquire()
        try:
            hurried = await control.dispatch.room()
            if control.state.halted:
                return
            wait = control.dispatch.take_delayed(name, self._reply)
            await control.dispatch.finish(wait, self._reply, first_ends=hurried)
        except (Stopped, PassoError) as error:
            problems = error.problems if isinstance(error, PassoError) else ()
            self._reply.fail(f"delayed_gcode.{name}: {error}", problems)
        finally:
            control.motion_lock.release()

    def _close(self) -> None:
        for due in self._due.values():
            due.cancel()
        for task in self._tasks:
            task.cancel()
