"""The page of features: its rows are complete, and each test that it names exists."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/coverage.md").read_text(encoding="utf-8")
NAMED = sorted(set(re.findall(r"`(tests/[\w/]+\.py)::(\w+)`", PAGE)))


@cache
def names_in(path: str) -> set[str]:
    """Names of the tests of a file."""
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
    return {node.name for node in tree.body if isinstance(node, kinds)}


def rows(heading: str) -> list[list[str]]:
    """The cells of a table."""
    part = PAGE.split(f"## {heading}\n")[1].split("\n## ")[0]
    lines = [line for line in part.splitlines() if line.startswith("| ")][1:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


@pytest.mark.parametrize("heading", ["APrinter", "StuFW"])
def test_every_row_has_a_test_or_says_what_is_open(heading):
    table = rows(heading)
    assert [int(row[0]) for row in table] == list(range(1, 74))
    assert [row for row in table if not row[2] and not row[3]] == []


def test_every_test_that_is_named_exists():
    assert len(NAMED) > 100
    assert [f"{path}::{name}" for path, name in NAMED if name not in names_in(path)] == []
    for cells in rows("Faults not carried over"):
        assert re.search(r"`tests/[\w/]+\.py::\w+`", cells[1]), cells[0]


def test_every_scenario_is_named():
    written = {
        (str(path.relative_to(ROOT)), name)
        for path in (ROOT / "tests/scenarios").glob("test_*.py")
        for name in names_in(str(path.relative_to(ROOT)))
        if name.startswith("test_")
    }
    assert sorted(written - set(NAMED)) == []
