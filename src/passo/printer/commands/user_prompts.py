"""Messages to the user at the printer, and waits for an answer."""

from __future__ import annotations

import re
from collections.abc import Callable, Generator
from contextlib import contextmanager

from passo.gcode.command import Command, numeral, words_of
from passo.gcode.parameters import number, rest, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.commands.beeper import Beeper
from passo.printer.state import State
from passo.printer.wait_requests import Reply, Wait, WaitForUser

# Words count only at the beginning: "M0 S30 Remove clip3", not "M0 Remove clip3". The rest is a
# message, which the lexer does not split.
_WORDS = re.compile(r"\s*(?:[PS]\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:\s+|$))+", re.IGNORECASE | re.ASCII)


class UserPrompts:
    """M0, M1, M85, M117 and SET_DISPLAY_TEXT of one printer."""

    def __init__(self, state: State, beeper: Beeper) -> None:
        self._state, self._beeper = state, beeper
        self.message = ""
        self.question = ""  # the question that hosts show
        # the question belongs to a wait that an answer ends, not to a paused print
        self.awaited = False
        self.for_ever = False  # a wait without a timeout is open
        self.wait_listeners: list[Callable[[], None]] = []  # called when a wait for a user begins
        self.kill_s = 0.0  # M85: after this idle time, the printer halts

    @command(
        "M0",
        Subject.STOPS,
        When.EXCLUSIVE,
        "Waits for the user, M108 or the time.",
        number("S", "the longest wait", "s"),
        number("P", "the longest wait", "ms"),
        rest("text", "what the user sees"),
        kind=Kind.USER,
    )
    @command(
        "M1",
        Subject.STOPS,
        When.EXCLUSIVE,
        "Waits for the user, M108 or the time.",
        number("S", "the longest wait", "s"),
        number("P", "the longest wait", "ms"),
        rest("text", "what the user sees"),
        kind=Kind.USER,
    )
    def _wait(self, command: Command, _: Reply) -> Wait | None:
        found = _WORDS.match(command.text)
        head = found[0] if found else ""
        words = dict(words_of(head))
        seconds = words.get("S", words.get("P", 0.0) / 1000)
        text = command.text[len(head) :].strip() or "Waiting; continue with M108"
        return WaitForUser(text, max(seconds, 0.0))

    @property
    def asking(self) -> bool:
        """Whether hosts show a question."""
        return bool(self.question)

    def ask(self, text: str, *, awaited: bool = True) -> None:
        """Makes hosts show the text and a button to continue, and beeps. `awaited`: the answer ends
        a wait."""
        for words in (f"prompt_begin {text}", "prompt_button Continue", "prompt_show"):
            self._state.tell(f"// action:{words}")
        self._beeper.call()
        self.question, self.awaited = text, awaited

    @contextmanager
    def waited_for(self, *, for_ever: bool = True) -> Generator[None]:
        """Marks a wait for the user, at standstill, within the block. `for_ever`: the wait has no
        timeout."""
        self.for_ever = for_ever
        for listener in list(self.wait_listeners):
            listener()
        try:
            yield
        finally:
            self.for_ever = False

    def answered(self) -> None:
        """Call this when the user has answered, or when no wait or pause is left: hosts remove the
        question."""
        if self.asking:
            self.question, self.awaited = "", False
            self._state.tell("// action:prompt_end")

    @command(
        "M117",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "Sends a message to displays and hosts.",
        rest("text", "the message"),
        kind=Kind.QUIET,
    )
    def _show(self, command: Command, _: Reply) -> None:
        self._display(command.text)

    @command(
        "SET_DISPLAY_TEXT",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "Sends a message to displays and hosts, as M117; without MSG it removes the message.",
        text("MSG", "the message"),
        kind=Kind.QUIET,
    )
    def _set_text(self, command: Command, _: Reply) -> None:
        self._display(command.string("MSG", ""))

    def _display(self, message: str) -> None:
        self.message = message
        self._state.tell(f"// action:notification {message}")

    @command(
        "M85",
        Subject.MOTORS,
        When.IMMEDIATE,
        "Switches everything off after this idle time; 0: never.",
        number("S", "the idle time; 0: never", "s", 0),
        kind=Kind.SERVED,
    )
    def _kill_after(self, command: Command, reply: Reply) -> Wait | None:
        if command.has("S"):
            self.kill_s = command.value("S")  # 0 means never
        else:
            reply.say(self.kill_line())
        return None

    def kill_line(self) -> str:
        """M85 with the current value."""
        return f"M85 S{numeral(self.kill_s)}"
