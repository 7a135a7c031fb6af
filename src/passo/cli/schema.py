"""`passo schema`: the JSON Schema of the machine file, with which editors complete and check it."""

from __future__ import annotations

import argparse
import json

from passo.errors import ExitStatus


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """`passo schema` has no arguments."""


def run(arguments: argparse.Namespace) -> int:
    """Prints the schema."""
    from passo.config.machine_schema import schema

    print(json.dumps(schema(), indent=2, ensure_ascii=False))
    return ExitStatus.DONE
