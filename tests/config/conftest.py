"""The text of the i3, to be changed by tests."""

from pathlib import Path

import pytest

import passo.config


@pytest.fixture
def i3_text() -> str:
    """Machine file of the i3; its last table is `[board]`."""
    return (Path(passo.config.__file__).parent / "machines" / "i3.toml").read_text()
