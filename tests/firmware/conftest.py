"""The boards of these tests run the firmware."""

import pytest
from tests.board.bench import Kind


@pytest.fixture(scope="module", autouse=True)
def firmware():
    Kind.firmware = "passo"
    yield
    Kind.firmware = "virtual"
