"""`passo calculate`: computes with the formulas of the lessons."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict

from passo.errors import ExitStatus


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo calculate`."""
    parser.add_argument(
        "calculator", nargs="?", metavar="CALCULATOR", help="a calculator; without: list them"
    )
    parser.add_argument(
        "values", nargs="*", metavar="KEY=VALUE", help="its parameters; without: their defaults"
    )
    parser.add_argument("--lang", choices=("en", "it"), default="en", help="default: en")
    parser.add_argument(
        "--json", action="store_true", help="print one JSON object and nothing else"
    )


def run(arguments: argparse.Namespace) -> int:
    """Prints the numbers of a calculator, or the calculators."""
    from passo.cli.learn import read_values
    from passo.cli.lesson_text import outcome_text
    from passo.cli.tables import rows
    from passo.learn.bilingual import said
    from passo.learn.course import all_calculators, calculator
    from passo.learn.views import outcome_view

    if arguments.calculator is None:
        pairs = [(one.name, said(one.about, arguments.lang)) for one in all_calculators()]
        print(rows(pairs))
        return ExitStatus.DONE
    chosen = calculator(arguments.calculator)
    given = read_values(arguments.values)
    if arguments.json:
        print(json.dumps(asdict(outcome_view(chosen, given, arguments.lang))))
    else:
        print(outcome_text(chosen, given, arguments.lang))
    return ExitStatus.DONE
