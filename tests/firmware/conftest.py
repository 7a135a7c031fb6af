"""The boards of these tests run the firmware."""

import pytest
from tests.support.link_bench import Kind


@pytest.fixture(scope="module", autouse=True)
def firmware():
    Kind.firmware = "passo"
    yield
    Kind.firmware = "virtual"
