"""`passo print --json` in this process."""

from __future__ import annotations

import json
from typing import Any

import pytest

from passo.cli.main import main


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    """The result of a print that succeeds; `words` are the file and further options."""
    assert main(["print", *words, "--assume-ready", "--json"]) == 0
    return json.loads(capsys.readouterr().out)
