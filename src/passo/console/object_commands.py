"""M486 and EXCLUDE_OBJECT from consoles: lists and cancels the objects of a print."""

from __future__ import annotations

from passo import _core
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import rest
from passo.gcode.registry import Kind, Subject, When, command
from passo.job.live.objects import PrintObjects
from passo.printer.status import PrintObject
from passo.printer.wait_requests import Reply, Wait

_Action = _core.ObjectAction
_OF_A_FILE = (
    "labels objects of a file on the card, which can be cancelled. A host that sends its file"
    " skips objects itself"
)


class ObjectCommands:
    """M486, EXCLUDE_OBJECT and the labels of one printer's consoles."""

    def __init__(self, objects: PrintObjects) -> None:
        self._objects = objects

    @command(
        "M486",
        Subject.PRINTS,
        When.IMMEDIATE,
        "P cancels an object of a print from the SD card, C the current one, U prints it again;"
        " without parameters it lists the objects. Files label their objects with T, S and A.",
        rest("P(object) U(object) C T(count) S(object) A(name)", "an object by its number"),
    )
    @command(
        "EXCLUDE_OBJECT",
        Subject.PRINTS,
        When.IMMEDIATE,
        "NAME= cancels an object of a print from the SD card, CURRENT=1 the current one; RESET=1"
        " prints all again, with NAME= this one. Without parameters it lists the objects.",
        rest("NAME=TEXT CURRENT=1 RESET=1", "an object by its name, which may have blanks"),
    )
    def _order(self, command: Command, reply: Reply) -> Wait | None:
        """Executes M486. Raises CommandError."""
        orders = _core.object_orders(command.code, command.text)
        if not command.text.strip():
            self._list(reply)
        elif not orders:
            limit = "P, U or C" if command.letter else "NAME=, CURRENT=1 or RESET=1"
            raise CommandError.of("job.no-object-order", value=command.text[:60], limit=limit)
        for action, number, name in orders:
            if action in (_Action.CANCEL, _Action.RESTORE):
                number = self._objects.named(name) if number < 0 else number
                self._cancel(number, reply, cancelled=action == _Action.CANCEL)
            elif action == _Action.CANCEL_CURRENT:
                current = self._objects.current
                if current is None:
                    raise CommandError.of("job.no-current-object")
                self._cancel(current, reply, cancelled=True)
            elif action == _Action.RESTORE_ALL:
                for found in self._objects.all:
                    if found.cancelled:
                        self._cancel(found.number, reply, cancelled=False)
            else:
                self._label(command, reply)
        return None

    @command(
        "EXCLUDE_OBJECT_DEFINE",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Defines an object of a file on the SD card.",
        rest("NAME=TEXT CENTER=X,Y POLYGON=POINTS", "the object, its middle in mm and its outline"),
        kind=Kind.MOTION,
    )
    @command(
        "EXCLUDE_OBJECT_START",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Starts the lines of an object in a file.",
        rest("NAME=TEXT", "the object"),
        kind=Kind.MOTION,
    )
    @command(
        "EXCLUDE_OBJECT_END",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Ends the lines of an object in a file.",
        rest("NAME=TEXT", "the object"),
        kind=Kind.MOTION,
    )
    def _label(self, command: Command, reply: Reply) -> None:
        reply.note(command.code, f"{command.code} {_OF_A_FILE}")

    def _cancel(self, number: int, reply: Reply, *, cancelled: bool) -> None:
        changed = self._objects.cancel(number, cancelled=cancelled)
        text = (
            f"Object {_shown(self._objects.all[number])} is {'' if cancelled else 'not '}cancelled"
        )
        if not changed:
            reply.say(f"echo:{text} already" if cancelled else f"echo:{text}")
            return
        planned = f"moves up to line {self._objects.planned_to_line} are planned already"
        then = "still printed" if cancelled else "not printed if they are its own"
        reply.say(f"echo:{text}; {planned} and {then}")

    def _list(self, reply: Reply) -> None:
        """Reports a line for each object: its number, its name, and whether it is current or
        cancelled."""
        found, current = self._objects.all, self._objects.current
        reply.say(f"echo:Objects: {len(found)}")
        for one in found:
            notes = [
                *(["printed now"] if one.number == current else []),
                *(["cancelled"] if one.cancelled else []),
            ]
            reply.say(f"echo:{_shown(one)}{': ' if notes else ''}{', '.join(notes)}")


def _shown(one: PrintObject) -> str:
    return f"{one.number} {one.name}" if one.name else f"{one.number}"
