"""A slicer uploads to `passo serve` as it does to OctoPrint, and the file is printed."""

import http.client
import json

import pytest
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
