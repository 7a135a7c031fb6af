"""The page of features: its rows are complete, and each test that it names exists."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from passo.gcode.registry import Kind, table

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "tests/coverage.md").read_text(encoding="utf-8")
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
def test_every_row_has_a_test_or_names_what_is_open(heading):
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


def numbers(text: str) -> set[int]:
    """Of words like 17 and 20-34."""
    found: set[int] = set()
    for word in text.split():
        first, _, last = word.partition("-")
        found |= set(range(int(first), int(last or first) + 1))
    return found


# Every command that StuFW or APrinter can be built with.
G_CODES = "0-5 10-12 20 21 26-32 38 42 60 61 90-92"
M_CODES = """
    0 1 17 18 20-34 42-44 48 49 70 73 75-78 80-85 92 99 100 104-125 140-142 145 149 150 155 163-166
    190-192 200 201 203-209 218 220-224 226 240 250 280 281 290 300-303 305 306 350 351 355 400-402
    404-408 410 413 420 421 428 500-503 512 524 530-532 540 561 569 595 600 602-605 666 701 702 800
    851 900 906-908 911-922 925 926 928 930 932 933 935-938 940-943 945-947 999 9999
"""


def test_each_foreign_command_is_built_or_has_a_reason():
    named: set[str] = set()
    for cells in rows("Commands that are not built"):
        assert cells[1]
        assert cells[2]
        named |= set(re.findall(r"[GM]\d+", spread(cells[0])))
    wanted = {f"G{n}" for n in numbers(G_CODES)} | {f"M{n}" for n in numbers(M_CODES)}
    built = table().keys() | {code.partition(".")[0] for code in table()}  # G38 is G38.2 and so on
    assert sorted(wanted - named - built) == []


def spread(text: str) -> str:
    """`M3 to M5` in full."""

    def full(match: re.Match[str]) -> str:
        return " ".join(f"M{n}" for n in range(int(match[1]), int(match[2]) + 1))

    return re.sub(r"M(\d+) to M(\d+)", full, text)


def test_commands_answer_the_notes_in_the_reference():
    for cells in rows("Commands that are not built"):
        for code in re.findall(r"[GM]\d+\b(?! [A-Z])", spread(cells[0])):
            if cells[2] == "unknown":
                assert code not in table(), code
            elif cells[2] == "a note":
                assert table()[code].kind in (Kind.QUIET, Kind.NOT_BUILT), code
