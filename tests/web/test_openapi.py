"""The interface does what its description says, whatever is sent."""

import asyncio

import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from schemathesis.specs.openapi.checks import positive_data_acceptance
from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import accounts, site

from passo.web.answers import JSON
from passo.web.openapi import PATH
from passo.web.operations import OPERATIONS
from passo.web.roles import Role

EXAMPLES = 10  # of each operation
LISTED = [operation for operation in OPERATIONS if not operation.compatible]


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """An application with an administrator, a key, and a card."""
    kept = accounts()

    async def fill():
        await kept.create_administrator("ada", "correct horse", "address", None)
        return (await kept.add_key("fuzzer", Role.ADMIN))[1]

    bridge = FakeBridge(str(tmp_path_factory.mktemp("card")))
    return site(bridge, kept, names=["testserver"]), asyncio.run(fill())


@pytest.fixture(scope="module")
def schema(served):
    return schemathesis.openapi.from_asgi(PATH, served[0])


@pytest.mark.parametrize("operation", LISTED, ids=lambda operation: operation.name)
def test_operation_keeps_to_its_description(operation, schema, served):
    # What a file holds, and which names a card has, is not in the description.
    unknown = {"card.name", "config.syntax"}.intersection(operation.errors)
    undescribed = operation.consumes != JSON or unknown
    excluded = [positive_data_acceptance] if undescribed else []

    @given(schema[operation.template][operation.method].as_strategy())
    @settings(
        max_examples=EXAMPLES,
        derandomize=True,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    def run(case):
        case.call_and_validate(headers={"X-Api-Key": served[1]}, excluded_checks=excluded)

    run()
