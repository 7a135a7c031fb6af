"""Commands that concern only the console that they came from."""

from __future__ import annotations

from passo.console.session import Session
from passo.printer.printer import Printer
from passo.printer.reports import Reports
from passo.printer.waits import Handler, Reply, Wait
from passo.printer.words import Command


class ConsoleCommands:
    """M110, M113, M118, M154, M155, M932, M933: they need the session that sends them."""

    def __init__(self, printer: Printer, reports: Reports) -> None:
        self._printer, self._reports = printer, reports
        self.handlers: dict[str, Handler] = {
            "M108": _nothing,  # acted when the line came in
            "M110": _nothing,
            "M112": _nothing,
            "M999": self._revive,
            "M113": self._busy,
            "M118": self._message,
            "M154": self._report_position,
            "M155": self._report_temperatures,
            "M932": self._strict,
            "M933": self._lenient,
        }

    def _busy(self, command: Command, reply: Reply) -> Wait | None:
        seconds = command.words().get("S")
        if isinstance(reply, Session):
            if seconds is None:
                reply.say(f"M113 S{reply.busy_s:g}")
            else:
                reply.busy_s = min(max(seconds, 0.0), 60.0)
        return None

    def _message(self, command: Command, _: Reply) -> Wait | None:
        text, prefix = command.text, ""
        while text[:2] in ("E1", "A1"):
            prefix += "echo:" if text[0] == "E" else "// "
            text = text[2:].lstrip()
        self._printer.tell(prefix + text)
        return None

    def _report_position(self, command: Command, reply: Reply) -> Wait | None:
        seconds = command.words().get("S", 0.0)
        if isinstance(reply, Session):
            reply.every("position", seconds, lambda: reply.hear(self._reports.position()))
        return None

    def _report_temperatures(self, command: Command, reply: Reply) -> Wait | None:
        seconds = command.words().get("S", 0.0)
        if isinstance(reply, Session):
            reply.every(
                "temperatures",
                seconds,
                lambda: reply.hear(f" {self._reports.temperatures()}"),
            )
        return None

    def _revive(self, _: Command, __: Reply) -> Wait | None:
        self._printer.revive()
        return None

    def _strict(self, _: Command, reply: Reply) -> Wait | None:
        if isinstance(reply, Session):
            reply.strict, reply.failed = True, False
        return None

    def _lenient(self, _: Command, reply: Reply) -> Wait | None:
        if isinstance(reply, Session):
            reply.strict = False
        return None


def _nothing(_: Command, __: Reply) -> Wait | None:
    return None
