"""Property tests draw the same examples on every run; a long test has a reason."""

import pytest
from hypothesis import settings

settings.register_profile("same", derandomize=True, deadline=None)
settings.load_profile("same")


def pytest_collection_modifyitems(items):
    for item in items:
        if item.get_closest_marker("long") and not item.function.__doc__:
            raise pytest.UsageError(f"{item.nodeid}: its docstring must say why it is long")
