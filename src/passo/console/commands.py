"""Commands that concern only the console that they came from."""

from __future__ import annotations

import re
from collections.abc import Callable

from passo.console.session import Session
from passo.gcode.command import Command
from passo.printer.commands.ranges import beyond
from passo.printer.commands.reports import Reports
from passo.printer.printer import Printer
from passo.printer.wait_requests import Handler, Reply, Wait

_OPTION = re.compile(r"([AEPaep])(\d)(?:\s+|\Z)")  # of M118; P, the port, has no meaning here


class ConsoleCommands:
    """M110, M113, M118, M154, M155, M932, M933: they need the session that sends them."""

    def __init__(self, printer: Printer, reports: Reports) -> None:
        self._printer, self._reports = printer, reports
        self.handlers: dict[str, Handler] = {
            "M108": _nothing,  # acted when the line came in, as M110, M112 and M410
            "M110": _nothing,
            "M112": _nothing,
            "M410": _nothing,
            "M999": self._restart,
            "M113": self._busy,
            "M118": self._message,
            "M154": self._report_position,
            "M155": self._report_temperatures,
            "M921": self._trace,
            "M932": self._strict,
            "M937": lambda c, r: _say(r, "echo:No corrections of the bed are in effect"),
            "M940": lambda c, r: _say(
                r, "echo:The network is the computer's; see passo serve --tcp"
            ),
            "M933": self._lenient,
        }

    def _busy(self, command: Command, reply: Reply) -> Wait | None:
        seconds = command.words().get("S")
        if isinstance(reply, Session):
            if seconds is None:
                reply.say(f"M113 S{reply.busy_s:g}")
            else:
                reply.busy_s = min(max(seconds, 0.0), 60.0)
                if note := beyond("M113", seconds, (0.0, 60.0), "s"):
                    reply.say(f"echo:{note}")
        return None

    def _message(self, command: Command, _: Reply) -> Wait | None:
        text, marks = command.text, set[str]()
        while option := _OPTION.match(text):
            marks.add(option[1].upper() if option[2] != "0" else "")
            text = text[option.end() :]
        prefix = ("echo:" if "E" in marks else "") + ("// " if "A" in marks else "")
        self._printer.tell(prefix + text)
        return None

    def _report_position(self, command: Command, reply: Reply) -> Wait | None:
        seconds = command.words().get("S", 0.0)
        if isinstance(reply, Session):
            reply.report_every("position", seconds, lambda: reply.hear(self._reports.position()))
        return None

    def _report_temperatures(self, command: Command, reply: Reply) -> Wait | None:
        seconds = command.words().get("S", 0.0)
        if isinstance(reply, Session):
            reply.report_every(
                "temperatures",
                seconds,
                lambda: reply.hear(f" {self._reports.temperatures()}"),
            )
        return None

    def _trace(self, command: Command, reply: Reply) -> Wait | None:
        """Once, or on this console every S seconds until S0: what each controller does."""
        seconds = command.words().get("S")
        if isinstance(reply, Session) and seconds is not None:
            reply.report_every("trace", seconds, lambda: self._show_trace(reply.hear))
        else:
            self._show_trace(reply.say)
        return None

    def _show_trace(self, say: Callable[[str], None]) -> None:
        for name, heater in self._printer.connection.heaters.items():
            t = heater.terms
            say(
                f"//trace {name}: {heater.celsius:.2f} /{heater.target:.2f} error:{t.error:.3f}"
                f" p:{t.p:.4f} i:{t.i:.4f} d:{t.d:.4f} out:{t.output:.4f}"
            )

    def _restart(self, _: Command, __: Reply) -> Wait | None:
        self._printer.request_restart()
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


def _say(reply: Reply, text: str) -> Wait | None:
    reply.say(text)
    return None
