"""APrinter's run-time options by their names: M925 reports an option, M926 stores a pending value,
M930 applies the pending values."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from typing import TYPE_CHECKING

from passo.console.aprinter_option_table import Option, options
from passo.errors import CommandError
from passo.gcode.command import Command, numeral, unescaped
from passo.gcode.parameters import rest
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.wait_requests import NullReply, Reply, Wait, WaitForMoves

if TYPE_CHECKING:
    from passo.printer.dispatch import Dispatch
    from passo.printer.settings import Settings


class OptionCommands:
    """M925, M926 and M930 of one printer."""

    def __init__(self, dispatch: Dispatch, settings: Settings) -> None:
        self._dispatch, self._settings = dispatch, settings
        self._options = {option.name.lower(): option for option in options(settings)}
        self._defaults = {name: option.value() for name, option in self._options.items()}
        self.pending: dict[str, float] = {}  # by name in lower case

    def pending_lines(self) -> Iterator[str]:
        """The pending values as commands in comments."""
        for name, value in self.pending.items():
            yield f"; pending until M930: M926 I{self._options[name].name} V{numeral(value)}"

    def pending_values(self) -> dict[str, float]:
        """The pending values by name."""
        return {self._options[name].name: value for name, value in self.pending.items()}

    # -- commands ---------------------------------------------------------------------------------

    def _named(self, command: Command) -> tuple[Option, str | None]:
        words = {word[0].upper(): word[1:] for word in reversed(command.text.split())}
        name = unescaped(words.get("I", ""))
        option = self._options.get(name.lower())
        if option is None:
            raise CommandError.of("option.unknown", value=name or "without a name")
        return option, words.get("V")

    @command(
        "M925",
        Subject.SETTINGS,
        When.IMMEDIATE,
        "Reports one of APrinter's options.",
        rest("I(option)", "the name of the option"),
        kind=Kind.QUIET,
    )
    def _tell(self, command: Command, reply: Reply) -> Wait | None:
        option, _ = self._named(command)
        reply.say(numeral(option.value()))
        return None

    @command(
        "M926",
        Subject.SETTINGS,
        When.IMMEDIATE,
        "Notes a new value of an option, without V its first value.",
        rest("I(option) V(value)", "the name of the option, and its value"),
        kind=Kind.SERVED,
    )
    def _note(self, command: Command, _: Reply) -> Wait | None:
        option, text = self._named(command)
        if not option.command:
            raise CommandError.of("command.fixed", value=option.name)
        name = option.name.lower()
        try:
            value = self._defaults[name] if text is None else float(text)
            if not isfinite(value):
                raise ValueError(text)
        except ValueError:
            raise CommandError.of(
                "command.value", axis="V", value=text or "nothing", limit="a number"
            ) from None
        self.pending[name] = value
        return None

    @command(
        "M930",
        Subject.SETTINGS,
        When.EXCLUSIVE,
        "Applies the options that M926 has noted.",
        kind=Kind.SERVED,
    )
    def _apply(self, _: Command, reply: Reply) -> Wait | None:
        return WaitForMoves(lambda: self._apply_now(reply))

    def _apply_now(self, reply: Reply) -> None:
        if any(self._options[name].command.startswith("M92 ") for name in self.pending):
            self._settings.motion.settings.require_scales("M930")
        pending, self.pending = self.pending, {}
        for name, value in pending.items():
            option = self._options[name]
            before = option.value()
            line = option.command.format(numeral(value * option.scale))
            self._dispatch.take_setting(line, NullReply())
            if option.value() == before != value:
                reply.say(f"echo:{option.name} stays at {numeral(before)}; {line} was not taken")
