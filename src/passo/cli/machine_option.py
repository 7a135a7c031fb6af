"""Options of several subcommands."""

from __future__ import annotations

import argparse
import os
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.job.batch.policy import Policy
    from passo.printer.unfit_commands import Skips


def add_machine(parser: argparse.ArgumentParser) -> None:
    """`--machine NAME|FILE.toml`."""
    parser.add_argument(
        "--machine",
        default="i3",
        metavar="NAME|FILE.toml",
        help="a shipped machine (see `passo machines`) or a machine file; default: i3",
    )


def add_policy(parser: argparse.ArgumentParser) -> None:
    """Declares `--out-of-range` and `--missing-tool`."""
    parser.add_argument(
        "--out-of-range",
        choices=("stop", "clamp"),
        default="stop",
        help="moves beyond the machine's limits: stop (default), or go to the limit",
    )
    parser.add_argument(
        "--missing-tool",
        choices=("stop", "ignore"),
        default="stop",
        help="tools that the machine lacks: stop (default), or continue with the current tool",
    )


def add_skips(parser: argparse.ArgumentParser) -> None:
    """`--unknown` and `--levelling`."""
    parser.add_argument(
        "--unknown",
        choices=("stop", "skip"),
        default="stop",
        help="unknown commands that may move the machine, such as START_PRINT: stop before the"
        " first move (default), or leave them out",
    )
    parser.add_argument(
        "--levelling",
        choices=("stop", "skip"),
        default="stop",
        help="bed levelling (G29) on a machine without a probe: stop before the first move"
        " (default), or print without it",
    )


def add_assume_ready(parser: argparse.ArgumentParser) -> None:
    """`--assume-ready`."""
    parser.add_argument(
        "--assume-ready",
        action="store_true",
        help="the machine is homed and its hotends are warm: for a piece of G-code that does"
        " neither itself",
    )


def skips_of(arguments: argparse.Namespace) -> Skips:
    """What a print may do in place of a failure, by the options of `add_policy` and `add_skips`."""
    from passo.printer.unfit_commands import Skips

    return Skips(
        unknown=arguments.unknown == "skip",
        levelling=arguments.levelling == "skip",
        clamp=arguments.out_of_range == "clamp",
        ignore_tools=arguments.missing_tool == "ignore",
    )


def policy_of(arguments: argparse.Namespace) -> Policy:
    """The policy of a print, by these options."""
    from passo.job.batch.policy import Policy

    return Policy(
        clamp=arguments.out_of_range == "clamp", ignore_tools=arguments.missing_tool == "ignore"
    )


def replaces_input(arguments: argparse.Namespace) -> bool:
    """Whether the output would replace the input file; if so, also reports an error on stderr."""
    output = os.path.realpath(arguments.output)
    for path, what in ((arguments.file, "G-code"), (arguments.machine, "machine file")):
        if output == os.path.realpath(path):
            print(f"{arguments.output}: it is the {what} itself, name another.", file=sys.stderr)
            return True
    return False
