"""`passo config explain KEY`: the meaning of a key of the machine file, and the source of its
value."""

from __future__ import annotations

import argparse
import textwrap
from typing import TYPE_CHECKING

from passo.cli.machine_option import add_machine
from passo.errors import ExitStatus

if TYPE_CHECKING:
    from passo.config.key_facts import KeyFacts

_WIDTH = 92


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments of `passo config`."""
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    explain = actions.add_parser(
        "explain",
        help="describe a key, its value, and where the value is set",
        description="Describe a key of the machine file, its value, and where the value is set.",
        allow_abbrev=False,
    )
    explain.add_argument(
        "key", metavar="KEY", help="a key, such as axes.x.speed_mm_s, or a table, such as homing.z"
    )
    add_machine(explain)


def run(arguments: argparse.Namespace) -> int:
    """Prints a paragraph for the key, or for each key of the table. Raises ConfigError."""
    from passo import config
    from passo.config.key_facts import key_facts

    facts = key_facts(config.load_and_question(arguments.machine), arguments.key)
    print("\n\n".join(_paragraph(fact) for fact in facts))
    return ExitStatus.DONE


def _paragraph(fact: KeyFacts) -> str:
    from passo.config.key_settings import setting_of

    described = fact.described
    kinds = {
        "Unit": described.unit,
        "Range": described.range,
        "Default": described.default.replace("–", "none"),
    }
    lines = [
        fact.key if fact.value is None else f"{fact.key} = {fact.value}",
        described.help,
        ". ".join(f"{kind}: {text}" for kind, text in kinds.items() if text) + ".",
        _source(fact),
    ]
    if setting := setting_of(fact.key):
        command, word = setting
        lines.append(f"{command} {word} changes it on a running printer, and M500 stores that.")
    plain = [line.replace("`", "").replace("*", "").replace("\\|", "|") for line in lines]
    head, *rest = plain
    wrapped = [
        f"  {line}"
        if line == _source(fact)  # do not break a path
        else textwrap.fill(line, _WIDTH, initial_indent="  ", subsequent_indent="  ")
        for line in rest
    ]
    return "\n".join([head, *wrapped])


def _source(fact: KeyFacts) -> str:
    if fact.place is not None:
        return f"Set in {fact.place}."
    if fact.value is None:
        return "Not set."
    computed = fact.described.default == "*required*"
    return "Not in a file: computed from other keys." if computed else "Not in a file: the default."
