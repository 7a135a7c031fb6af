"""The text of the i3, to be changed by tests."""

import pytest

from passo import config


@pytest.fixture
def i3_text() -> str:
    """Machine file of the i3; its last table is `[board]`."""
    return config.shipped_text("i3")
