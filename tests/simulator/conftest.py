"""Every test of the simulated board runs on both of its kinds: the model and the firmware."""

import pytest
from tests.support.link_bench import Kind


@pytest.fixture(scope="module", params=["virtual", "passo"], autouse=True)
def firmware(request):
    Kind.firmware = request.param
    yield request.param
    Kind.firmware = "virtual"
