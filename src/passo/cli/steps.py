"""`passo steps`: writes each step of each motor, as executed by the board."""

from __future__ import annotations

import argparse
import sys
from contextlib import suppress
from typing import Any

from passo.cli.machine_option import add_machine, add_policy, policy_of, replaces_input
from passo.errors import ExitStatus, InputError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo steps`."""
    parser.add_argument("file", help="the G-code file")
    parser.add_argument("--output", required=True, metavar="OUT.npz|OUT.vcd", help="file to write")
    add_machine(parser)
    times: dict[str, Any] = {"type": _seconds, "metavar": "S"}
    parser.add_argument(
        "--from",
        dest="from_s",
        default=0.0,
        help="only steps from this print time on, in s",
        **times,
    )
    parser.add_argument(
        "--to", dest="to_s", help="only steps before this print time, in s", **times
    )
    parser.add_argument("--ideal", action="store_true", help="add the ideal times, in seconds")
    add_policy(parser)


def _seconds(text: str) -> float:
    with suppress(ValueError):
        value = float(text)
        if 0 <= value < 1e8:
            return value
    raise argparse.ArgumentTypeError(f"{text!r} is not a time in seconds")


def run(arguments: argparse.Namespace) -> int:
    """Prints the file on the board and writes its steps."""
    if arguments.to_s is not None and arguments.to_s <= arguments.from_s:
        print(
            f"--to {arguments.to_s:g}: it must be later than --from {arguments.from_s:g}.",
            file=sys.stderr,
        )
        return ExitStatus.USAGE
    from passo import config
    from passo.job.batch.step_trace import trace_steps, write_steps

    if not arguments.output.lower().endswith((".npz", ".vcd")):
        print(f"{arguments.output}: the ending must be .npz or .vcd.", file=sys.stderr)
        return ExitStatus.USAGE
    if arguments.ideal and not arguments.output.lower().endswith(".npz"):
        print(f"--ideal: {arguments.output} has no place for it, name an .npz.", file=sys.stderr)
        return ExitStatus.USAGE
    if replaces_input(arguments):
        return ExitStatus.USAGE
    trace = trace_steps(
        config.load(arguments.machine),
        arguments.file,
        policy_of(arguments),
        from_s=arguments.from_s,
        to_s=arguments.to_s,
        ideal=arguments.ideal,
    )
    for line in trace.warnings:
        print(line, file=sys.stderr)
    try:
        write_steps(arguments.output, trace)
    except OSError as error:
        raise InputError.of(
            "output.unwritable", arguments.output, value=error.strerror or str(error)
        ) from None
    steps = ", ".join(f"{name} {len(ticks):,}" for name, ticks in trace.ticks.items())
    print(f"{arguments.output}: steps {steps}", file=sys.stderr)
    return ExitStatus.DONE
