"""Passo's host on a board whose firmware speaks of analog inputs in older words."""

import pytest
from tests.board.bench import Bench
from tests.firmware.library import library_for_older_hosts

from passo.simulator import dictionary


@pytest.fixture
def bench(tmp_path, monkeypatch):
    library = library_for_older_hosts(tmp_path)
    monkeypatch.setattr(dictionary, "firmware_library", lambda: library)
    monkeypatch.setattr("passo.simulator.board.firmware_library", lambda: library)
    return Bench()


def test_it_heats_and_watches_the_sensor(bench):
    assert not bench.connection.dictionary.takes("query_analog_in", "bytes_per_report")
    assert bench.connection.dictionary.takes("query_analog_in", "range_check_count")
    heater = bench.connection.heaters["hotend"]
    bench.connection.set_target("hotend", 150.0)
    bench.run(200.0)
    assert heater.celsius == pytest.approx(150.0, abs=1.0)
    told = []
    bench.connection.on_fault = lambda name, fault: told.append(name)
    bench.simulated.force_sensor("hotend", 1.0)
    bench.run(2.0)  # the host switches off, and asks anew, with wider limits
    assert told == ["hotend"]
    assert bench.simulated.output_value("hotend") == 0
    assert not bench.device.stopped
