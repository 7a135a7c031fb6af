"""`passo explain`: shows the moves, steps and bytes that one line of a file becomes."""

from __future__ import annotations

import argparse

from passo.cli.machine_option import add_machine, add_policy, policy_of
from passo.errors import ExitStatus


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo explain`."""
    parser.add_argument("place", type=_place, metavar="FILE:LINE", help="a line of a G-code file")
    add_machine(parser)
    add_policy(parser)


def _place(text: str) -> tuple[str, int]:
    file, _, line = text.rpartition(":")
    if not file or not line.isdecimal() or int(line) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not FILE:LINE")
    return file, int(line)


def run(arguments: argparse.Namespace) -> int:
    """Prints the explanation."""
    from passo import config
    from passo.learn.explain import explain
    from passo.learn.explanation import explanation_text

    file, line = arguments.place
    explanation = explain(config.load(arguments.machine), file, line, policy_of(arguments))
    print(explanation_text(explanation))
    return ExitStatus.DONE
