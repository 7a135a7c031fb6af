"""A slicer uploads to `passo serve` as it does to OctoPrint, and the file is printed."""

import http.client
import json
from pathlib import Path

import pytest
from tests.docs.test_how_tos import run
from tests.hosts.served import Served
from tests.web.slicers import recorded


@pytest.fixture
def printer(tmp_path):
    served = Served(tmp_path, web=True)
    yield served
    served.close()


def test_an_upload_with_print_prints(printer, program, at_end):
    sent = recorded.prusaslicer("gear.gcode", gcode=program.path.read_bytes())
    connection = http.client.HTTPConnection(printer.http, timeout=30)
    connection.request("GET", "/api/version")
    assert json.load(connection.getresponse())["text"].startswith("OctoPrint")
    connection.request("POST", "/api/files/local", sent["content"], sent["headers"])
    answer = connection.getresponse()
    assert (answer.status, json.load(answer)["effectivePrint"]) == (201, True)
    connection.close()
    printer.wait_for("Done printing file")
    at_end(printer)
    assert (printer.card / "gear.gcode").read_bytes() == program.path.read_bytes()


def test_commands_of_the_how_to_run(printer, tmp_path):
    page = Path(__file__).parents[2] / "docs/how-to/print-from-a-slicer.md"
    (tmp_path / "part.gcode").write_text("G28\nG1 X50 F6000\n")
    text = page.read_text(encoding="utf-8").replace("127.0.0.1:4000", printer.http)
    assert run(text, tmp_path) == 3
    printer.wait_for("Done printing file")
