"""Commands that affect only the console that has sent them."""

from __future__ import annotations

import re
from collections.abc import Callable

from passo.console.session import Session
from passo.errors import CommandError, ConfigError
from passo.gcode.command import Command
from passo.gcode.parameters import choice, number, rest, shown, text
from passo.gcode.registry import Kind, Subject, When, command, row_of, table
from passo.printer.commands.ranges import beyond
from passo.printer.commands.reports import Reports
from passo.printer.commands.temperature_report import TemperatureReport
from passo.printer.control import Control
from passo.printer.program_restart import ProgramRestart
from passo.printer.wait_requests import Reply, Wait

_PREFIXES = {"echo": "echo:", "error": "!!", "command": "//"}  # of RESPOND
_OPTION = re.compile(r"([AEPaep])(\d)(?:\s+|\Z)")  # options of M118; P, the port, has no effect


class ConsoleCommands:
    """M110, M113, M118, M154, M155, M932, M933, and Klipper's RESPOND, STATUS and HELP."""

    def __init__(
        self,
        control: Control,
        reports: Reports,
        temperatures: TemperatureReport,
        restart: ProgramRestart | None,
    ) -> None:
        """`restart` restarts the program; None if it cannot restart."""
        self._rig, self._state, self._stops = control.rig, control.state, control.stops
        self._reports, self._temperatures, self._program = reports, temperatures, restart

    @command(
        "M108",
        Subject.STOPS,
        When.AHEAD,
        "Cancels the current wait.",
        kind=Kind.QUIET,
    )
    @command(
        "M110",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "Sets the number of the line before the next one.",
        rest("N", "the number"),
        kind=Kind.QUIET,
    )
    @command(
        "M112",
        Subject.STOPS,
        When.AHEAD,
        "Emergency stop: everything off at once; M999 restarts. A print without consoles fails"
        " there.",
        in_turn=True,
    )
    @command(
        "M410",
        Subject.STOPS,
        When.AHEAD,
        "Brakes to a stop, and drops all planned moves and the moves that a console has sent. A"
        " print without consoles fails there.",
        in_turn=True,
    )
    def _acted(self, _: Command, __: Reply) -> None:
        """Does nothing, because these commands took effect when the line was received."""

    @command(
        "M113",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "Sets how often a command that waits reports that it is busy.",
        number("S", "how often; 0: never", "s", 0, 60, clamped=True, alone=True),
        kind=Kind.QUIET,
    )
    def _busy(self, command: Command, reply: Reply) -> Wait | None:
        seconds = command.value("S", None)
        if isinstance(reply, Session):
            if seconds is None:
                reply.say(f"M113 S{reply.busy_s:g}")
            else:
                reply.busy_s = min(max(seconds, 0.0), 60.0)
                if note := beyond("M113", seconds, (0.0, 60.0), "s"):
                    reply.say(f"echo:{note}")
        return None

    @command(
        "M118",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "Sends a line to all consoles.",
        rest("E1 A1 text", "the message; E1 begins it with echo:, A1 with //"),
        kind=Kind.QUIET,
    )
    def _message(self, command: Command, _: Reply) -> Wait | None:
        text, marks = command.text, set[str]()
        while option := _OPTION.match(text):
            marks.add(option[1].upper() if option[2] != "0" else "")
            text = text[option.end() :]
        prefix = ("echo:" if "E" in marks else "") + ("// " if "A" in marks else "")
        self._state.tell(prefix + text)
        return None

    @command(
        "ECHO",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "Sends a line to all consoles.",
        rest("text", "the message"),
        kind=Kind.QUIET,
    )
    def _echo(self, command: Command, _: Reply) -> None:
        self._state.tell(f"echo: {command.text.strip()}")

    @command(
        "RESPOND",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "Sends a line to all consoles: TYPE is echo, error or command.",
        choice("TYPE", "the kind of message", *_PREFIXES),
        text("PREFIX", "what begins the line, in place of TYPE"),
        text("MSG", "the message"),
        kind=Kind.QUIET,
    )
    def _respond(self, command: Command, _: Reply) -> None:
        """RESPOND."""
        prefix = command.string("PREFIX", _PREFIXES[command.string("TYPE", "echo").lower()])
        self._state.tell(f"{prefix} {command.string('MSG')}")

    @command(
        "STATUS",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "Reports whether the printer runs.",
        kind=Kind.QUIET,
    )
    def _status(self, _: Command, reply: Reply) -> None:
        halted = self._state.halted
        reply.say(f"echo:The printer is halted: {halted}" if halted else "echo:The printer runs")

    @command(
        "HELP",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "Lists all commands, or shows one with its parameters.",
        rest("COMMAND", "one command, to show its parameters"),
        kind=Kind.QUIET,
    )
    def _help(self, command: Command, reply: Reply) -> None:
        if not (wanted := command.text.strip().upper()):
            for code, row in table().items():
                reply.say(f"echo:{code}: {row.text}")
            return
        found = row_of(wanted)
        if found is None:
            limit = "a command that HELP lists"
            raise CommandError.of("command.value", axis="HELP", value=wanted[:30], limit=limit)
        reply.say(f"echo:{wanted}: {found.text}")
        for parameter in shown(found.parameters):
            reply.say(f"echo:  {parameter.usage}: {parameter.text}")

    @command(
        "M154",
        Subject.POSITIONS,
        When.IMMEDIATE,
        "Reports the position every S seconds.",
        number("S", "how often; 0: no more", "s", alone=True),
        kind=Kind.QUIET,
    )
    def _report_position(self, command: Command, reply: Reply) -> Wait | None:
        seconds = command.value("S", 0.0)
        if isinstance(reply, Session):
            reply.report_every("position", seconds, lambda: reply.hear(self._reports.position()))
        return None

    @command(
        "M155",
        Subject.HEATERS,
        When.IMMEDIATE,
        "Reports the temperatures every S seconds.",
        number("S", "how often; 0: no more", "s", alone=True),
        kind=Kind.QUIET,
    )
    def _report_temperatures(self, command: Command, reply: Reply) -> Wait | None:
        seconds = command.value("S", 0.0)
        if isinstance(reply, Session):
            reply.report_every(
                "temperatures",
                seconds,
                lambda: reply.hear(f" {self._temperatures.line()}"),
            )
        return None

    @command(
        "M921",
        Subject.HEATERS,
        When.IMMEDIATE,
        "Reports the terms of each heater's controller, with S every S seconds.",
        number("S", "how often; 0: no more", "s"),
        kind=Kind.QUIET,
    )
    def _trace(self, command: Command, reply: Reply) -> Wait | None:
        """Traces the state of each heater's controller, once or, with S, on this console every S
        seconds until S0."""
        seconds = command.value("S", None)
        if isinstance(reply, Session) and seconds is not None:
            reply.report_every("trace", seconds, lambda: self._show_trace(reply.hear))
        else:
            self._show_trace(reply.say)
        return None

    def _show_trace(self, say: Callable[[str], None]) -> None:
        for name, heater in self._rig.connection.heaters.items():
            t = heater.terms
            say(
                f"//trace {name}: {heater.celsius:.2f} /{heater.target:.2f} error:{t.error:.3f}"
                f" p:{t.p:.4f} i:{t.i:.4f} d:{t.d:.4f} out:{t.output:.4f}"
            )

    @command(
        "M999",
        Subject.STOPS,
        When.IMMEDIATE,
        "Restarts after a halt.",
        kind=Kind.SERVED,
    )
    def _restart(self, _: Command, __: Reply) -> Wait | None:
        self._stops.request_restart()
        return None

    @command(
        "RESTART",
        Subject.STOPS,
        When.IMMEDIATE,
        "Starts Passo again with its machine file as it is now: heaters and motors go off, consoles"
        " are closed and opened again. Refused while a file is printed, and for a file with errors."
        " With `--stdin`, and in a program that opened the printer, as FIRMWARE_RESTART.",
        kind=Kind.SERVED,
        in_turn=True,
    )
    def _restart_program(self, command: Command, reply: Reply) -> Wait | None:
        if self._program is None:
            return self._halt_and_restart(command, reply)
        try:
            self._program.check()
        except ConfigError as error:
            raise CommandError(error.problems) from None
        self._program.begin()
        return None

    @command(
        "FIRMWARE_RESTART",
        Subject.STOPS,
        When.IMMEDIATE,
        "Restarts the boards; the machine stays as it was read. All heaters and motors go off at"
        " once, and a print ends.",
        kind=Kind.SERVED,
        in_turn=True,
    )
    def _halt_and_restart(self, _: Command, __: Reply) -> Wait | None:
        self._stops.restart()
        return None

    @command(
        "M932",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "After a failure, refuses all commands of this console.",
        kind=Kind.QUIET,
    )
    def _strict(self, _: Command, reply: Reply) -> Wait | None:
        if isinstance(reply, Session):
            reply.strict, reply.failed = True, False
        return None

    @command(
        "M933",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "Ends M932.",
        kind=Kind.QUIET,
    )
    def _lenient(self, _: Command, reply: Reply) -> Wait | None:
        if isinstance(reply, Session):
            reply.strict = False
        return None

    @command(
        "M940",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "Reports that the network is the computer's.",
        kind=Kind.QUIET,
    )
    def _network(self, _: Command, reply: Reply) -> None:
        reply.say("echo:The network is the computer's; see passo serve --tcp")
