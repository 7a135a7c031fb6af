"""M486 and EXCLUDE_OBJECT of consoles: what is printed, and what is cancelled of it."""

from __future__ import annotations

from passo import _core
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.job.live.objects import PrintObjects
from passo.printer.status import PrintObject
from passo.printer.wait_requests import Handler, Reply, Wait

_Action = _core.ObjectAction
_OF_A_FILE = (
    "labels objects of a file on the card, which can be cancelled. A host that sends its file"
    " skips objects itself"
)


class ObjectCommands:
    """M486, EXCLUDE_OBJECT and the labels of one printer's consoles."""

    def __init__(self, objects: PrintObjects) -> None:
        self._objects = objects
        self.immediate: dict[str, Handler] = {
            "M486": self._order,
            "EXCLUDE_OBJECT": self._order,
            "EXCLUDE_OBJECT_DEFINE": _label,
            "EXCLUDE_OBJECT_START": _label,
            "EXCLUDE_OBJECT_END": _label,
        }

    def _order(self, command: Command, reply: Reply) -> Wait | None:
        """Raises CommandError."""
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
                _label(command, reply)
        return None

    def _cancel(self, number: int, reply: Reply, *, cancelled: bool) -> None:
        changed = self._objects.cancel(number, cancelled=cancelled)
        said = (
            f"Object {_shown(self._objects.all[number])} is {'' if cancelled else 'not '}cancelled"
        )
        if not changed:
            reply.say(f"echo:{said} already" if cancelled else f"echo:{said}")
            return
        planned = f"moves up to line {self._objects.planned_to_line} are planned already"
        then = "still printed" if cancelled else "not printed if they are its own"
        reply.say(f"echo:{said}; {planned} and {then}")

    def _list(self, reply: Reply) -> None:
        """One line for each object, as `number name`, and what is special of it."""
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


def _label(command: Command, reply: Reply) -> Wait | None:
    reply.note(command.code, f"{command.code} {_OF_A_FILE}")
    return None
