"""The passo command: runs the subcommand and turns errors into sentences and exit statuses.

Only the chosen subcommand's module is imported, so that `passo --help` starts at once. Such a
module offers `add_arguments(parser)` and `run(arguments) -> int`.
"""

from __future__ import annotations

import argparse
import gc
import importlib
import io
import os
import signal
import sys
from collections.abc import Sequence
from keyword import iskeyword
from pathlib import Path
from typing import Any

import passo
from passo.errors import ExitStatus, PassoError, Problem

# The start creates many objects and no garbage. Collections at Python's default interval would take
# a tenth of the start time.
_GC_THRESHOLD = 20_000
COMMANDS: dict[str, str] = {
    "print": "print a file on a simulated board, to the end, and say what came out",
    "serve": "serve a printer to OctoPrint and other hosts, on serial, pty, TCP or a terminal",
    "hub": "serve a farm: many printers, one queue, one page",
    "estimate": "say how long a file takes, by layer, feature and limit",
    "steps": "write every step of every motor, as the board executed it",
    "explain": "show what one line of a file becomes: plan, steps, bytes",
    "learn": "show the course: lessons with experiments and questions, in English or Italian",
    "calculate": "calculate with the formulas of the lessons: steps per mm, currents, heat",
    "report": "write one page with pictures: path, speeds, temperatures, limits",
    "lab": "print a file under several settings of the motion, and compare ringing and lines",
    "batch": "compute many files on many machines under many settings, as a table",
    "calibrate": "find a thermistor's β from what a thermometer says",
    "machines": "list the machines that come with Passo",
    "firmware": "list boards, build and flash their firmware",
    "init": "make a machine file: ask about the printer, and write what was answered",
    "import": "make a machine file from a configuration of Klipper, Marlin or APrinter, and report",
    "export": "make a printer.cfg of Klipper from a machine file",
    "unit": "print the unit by which systemd starts a printer",
    "check": "check a machine file and report everything that is wrong with it",
    "config": "explain a key of the machine file: meaning, value, and where it is set",
    "schema": "print the JSON Schema of the machine file, for editors",
}


def _parser(name: str | None) -> argparse.ArgumentParser:
    """The parser of the whole command line, with the arguments of the subcommand `name`."""
    parser = argparse.ArgumentParser(
        prog="passo", description="Passo: G-code in, exact step times out.", allow_abbrev=False
    )
    parser.add_argument("--version", action="version", version=f"passo {passo.__version__}")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for command, summary in COMMANDS.items():
        sentence = f"{summary[0].upper()}{summary[1:]}."
        subparser = subparsers.add_parser(
            command, help=summary, description=sentence, allow_abbrev=False
        )
        if command == name:
            _module(command).add_arguments(subparser)
    return parser


def _module(command: str) -> Any:
    """The module of a subcommand. `import` is a keyword of Python, so its module has a `_`."""
    return importlib.import_module(f"passo.cli.{command}{'_' if iskeyword(command) else ''}")


def endings() -> list[signal.Signals]:
    """The signals that end a command like Ctrl-C: SIGTERM, and SIGHUP unless it is ignored
    (nohup)."""
    numbers = (signal.SIGTERM, signal.SIGHUP)
    return [number for number in numbers if signal.getsignal(number) != signal.SIG_IGN]


def main(argv: Sequence[str] | None = None) -> int:
    """Runs `passo argv…` and returns its exit status: 0 done, 2 usage, 3 bad machine file,
    4 bad input or an output that cannot be written, 5 machine fault, 130 interrupted. Errors go to
    stderr, one line each."""
    gc.set_threshold(_GC_THRESHOLD)
    if argv is None:
        for number in endings():  # handle it like Ctrl-C, so that no partial file remains
            signal.signal(number, signal.default_int_handler)
    if sys.stderr is None:  # closed by the parent process: print() would write to standard output
        sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115
    elif argv is None:
        file = io.FileIO(2, "w", closefd=False)
        sys.stderr = _LossyStderr(io.BufferedWriter(file), sys.stderr.encoding, sys.stderr.errors)
        sys.stderr.reconfigure(line_buffering=True)
    if reconfigure := getattr(sys.stdout, "reconfigure", None):
        # characters that its encoding lacks are escaped, as on stderr
        reconfigure(errors="backslashreplace")
    try:
        status = _run(list(sys.argv[1:] if argv is None else argv))
    except OSError as error:
        if (failed := _flush("\n")) is None:
            raise  # standard output works, so the error has another cause
        cause = error.__context__  # the message that it was about to print
        return failed or (cause.status if isinstance(cause, PassoError) else ExitStatus.DONE)
    return _flush() or status


class _LossyStderr(io.TextIOWrapper):
    """Standard error. If a text cannot be written, for example on a full disk, it is lost, and the
    command continues."""

    def write(self, text: str, /) -> int:
        """Writes the text, or drops it and all later texts; returns its length. Raises nothing."""
        try:
            return super().write(text)
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), self.fileno())
            return len(text)


def _run(words: list[str]) -> int:
    name = next((word for word in words if not word.startswith("-")), None)
    try:
        arguments = _parser(name).parse_args(words)
        status: int = _module(arguments.command).run(arguments)
    except PassoError as error:
        for problem in error.problems:
            print(problem, file=sys.stderr)
        return error.status
    except SystemExit as exit_:  # argparse: help and version (0), usage (2)
        return ExitStatus.USAGE if exit_.code else ExitStatus.DONE
    except KeyboardInterrupt:
        print("Interrupted.", file=sys.stderr)
        return 130
    return status


def _flush(more: str = "") -> int | None:
    """Flushes standard output. If that fails, returns the exit status, and discards later
    output."""
    if sys.stdout is None:  # closed by the parent process
        return None
    try:
        if more:  # a full disk rejects even an empty write
            sys.stdout.write(more)
        sys.stdout.flush()
    except BrokenPipeError:  # the reader, for example `head`, has closed the pipe: report nothing
        status = ExitStatus.DONE
    except OSError as error:
        values = {"value": error.strerror or str(error)}
        problem = Problem("output.unwritable", "standard output", None, values)
        print(problem, file=sys.stderr)
        status = problem.entry.status
    else:
        return None
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return status
