"""A printer with a card: a folder with a print, a text, and a directory."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.support.card_print import SQUARE
from tests.support.scenario import Scenario


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The folder that is the card."""
    (tmp_path / "square.gcode").write_text(SQUARE)
    (tmp_path / "notes.txt").write_text("nothing to print")
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "A long name.gcode").write_text("G28 X\nM117 hello\nG1 X5\n")
    return tmp_path


@pytest.fixture
def s(folder: Path) -> Iterator[Scenario]:
    """The printer, with its host."""
    with Scenario("i3", card=str(folder)) as scenario:
        yield scenario
