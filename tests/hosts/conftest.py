"""The hosts' environment, a printer, and a file to print."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from tests.hosts.files import gear, pocket
from tests.hosts.served import Served

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def hosts() -> Path:
    """Programs of the environment in which OctoPrint and Printrun are installed."""
    folder = Path(os.environ.get("PASSO_HOSTS", ROOT / ".venv" / "hosts")) / "bin"
    if not (folder / "octoprint").exists():
        pytest.fail("OctoPrint and Printrun are missing: `make test` installs them from PyPI")
    return folder


@pytest.fixture(scope="session")
def program(tmp_path_factory):
    """A file of 2 000 moves with arcs."""
    return gear(tmp_path_factory.mktemp("files") / "gear.gcode", 2000)


@pytest.fixture
def printer(tmp_path):
    served = Served(tmp_path)
    yield served
    served.close()


@pytest.fixture
def router(tmp_path):
    """A router that knows where it is."""
    served = Served(tmp_path, "cnc")
    served.ask("G28")
    yield served
    served.close()


@pytest.fixture(scope="session")
def whole(tmp_path_factory):
    """A file as it came, to its last line."""
    return pocket(tmp_path_factory.mktemp("files") / "pocket.gcode")


@pytest.fixture
def at_end(program):
    """Asserts that the printer is where the file ends: no line lost, none carried out twice."""

    def check(printer):
        at = printer.position()
        for axis, value in program.end.items():
            assert at[axis] == pytest.approx(value, abs=0.0021), axis
        for axis, steps_per_mm in (("x", 80), ("y", 80), ("z", 400)):
            assert at[f"steps_{axis}"] == pytest.approx(program.end[axis] * steps_per_mm, abs=1)

    return check
