"""Delayed G-code of the machine file, which runs after a time."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from passo.config.part_names import found_name
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import number, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.wait_requests import Reply

if TYPE_CHECKING:
    from passo.printer.background_gcode import BackgroundGcode
    from passo.printer.control import Control

_MAX_S = 1e6


class DelayedGcode:
    """The delayed G-code of one printer, which `background` runs. Create it within a running event
    loop."""

    def __init__(self, control: Control, background: BackgroundGcode) -> None:
        self._known, self._background = control.machine.delayed_gcode, background
        self._due: dict[str, asyncio.TimerHandle] = {}
        for name, delayed in self._known.items():
            self._set(name, delayed.initial_duration_s)
        control.lifetime.at_end(self._close)

    @command(
        "UPDATE_DELAYED_GCODE",
        Subject.MACROS,
        When.PLANNED,
        "Carries out the delayed G-code of this name after this time; with 0 not at all.",
        text("ID", "the name in the machine file", required=True),
        number("DURATION", "the time; 0: not at all", "s", 0, _MAX_S, required=True),
        kind=Kind.SERVED,
    )
    def _update(self, command: Command, _: Reply) -> None:
        wanted = command.string("ID")
        name = found_name(self._known, wanted)
        if name is None:
            listed = ", ".join(self._known) or "none"
            raise CommandError.of("macro.no-delay", axis=wanted, value=listed)
        self._set(name, command.value("DURATION"))

    def _set(self, name: str, seconds: float) -> None:
        """Schedules an entry after `seconds`, instead of its earlier time; 0 cancels it."""
        if (due := self._due.pop(name, None)) is not None:
            due.cancel()
        if seconds > 0:
            loop = asyncio.get_running_loop()
            self._due[name] = loop.call_later(seconds, self._start, name)

    def _start(self, name: str) -> None:
        del self._due[name]
        self._background.start(f"delayed_gcode.{name}", self._known[name].gcode)

    def _close(self) -> None:
        for due in self._due.values():
            due.cancel()
