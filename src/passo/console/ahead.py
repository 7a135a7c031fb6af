"""Commands that act when their line comes in, ahead of every queue."""

from __future__ import annotations

from passo.printer.printer import Printer
from passo.printer.words import Command


class Ahead:
    """Sees the lines of one console as they come in, before those in hand are done."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self._for_file = False  # what comes in now goes into a file
        self._numbered = False  # and has numbers

    def see(self, command: Command, number: int | None) -> None:
        """Acts on M108, M112, M410 and M876, unless they are text for a file: in one whose lines
        have numbers, a line without is none."""
        code = command.code
        if code == "M28":
            self._for_file, self._numbered = True, False
        elif code == "M29":
            self._for_file = False
        elif self._for_file and (number is not None or not self._numbered):
            self._numbered = number is not None
        elif code == "M112":
            self._printer.halt("emergency stop by M112")
        elif code == "M108" or (code == "M876" and "S" in command.words()):
            self._printer.go_on()
        elif code == "M410":
            self._printer.stop_all("M410")
