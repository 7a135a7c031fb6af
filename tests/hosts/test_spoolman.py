"""Filament that Moonraker reports to Spoolman: the length that the print of Passo pushed."""

import pytest
from tests.hosts.moonraker import Moonraker
from tests.hosts.served import Served
from tests.hosts.spoolman import SPOOL, Spoolman

# Each layer pushes 10 mm, pulls 2 mm back and pushes them again. Its absolute E begins at 0.
LAYERS = 5
LAYER = "G92 E0\nG1 X60 E4 F6000\nG1 X40 E10\nG1 E8 F2400\nG1 Y{y}\nG1 E10\n"


@pytest.fixture
def spoolman():
    found = Spoolman()
    yield found
    found.close()


@pytest.fixture
def server(hosts, printer, spoolman, tmp_path):
    folder = tmp_path / "moonraker"
    folder.mkdir()
    settings = f"[spoolman]\nserver: {spoolman.url}\nsync_rate: 1\n"
    moonraker = Moonraker(hosts / "moonraker", folder, printer.klippy, printer.card, settings)
    moonraker.post("/server/spoolman/spool_id", spool_id=SPOOL)
    moonraker.wait(lambda: moonraker.get("/server/spoolman/status")["spoolman_connected"])
    yield moonraker
    moonraker.close()


@pytest.fixture
def printer(tmp_path):
    served = Served(tmp_path, klippy=True)
    yield served
    served.close()


def test_spool_loses_the_length_that_a_print_pushed(server, spoolman, tmp_path):
    layers = "".join(LAYER.format(y=40 + y) for y in range(LAYERS))
    file = tmp_path / "layers.gcode"
    file.write_text(f"M109 S180\nG28\nG90\nM82\nG1 X40 Y40 Z0.2 F6000\n{layers}M104 S0\n")
    spoolman.refuse = 1  # its report is repeated
    server.upload("/server/files/upload", file, print="true")
    server.wait(lambda: server.print_state == "complete")
    server.wait(lambda: sum(spoolman.uses_mm) > 10 * LAYERS - 0.01)
    assert sum(spoolman.uses_mm) == pytest.approx(10 * LAYERS, abs=0.01)
    assert spoolman.refuse == 0
