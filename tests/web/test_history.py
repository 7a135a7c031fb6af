"""Temperatures are kept for a day, in samples that do not become more."""

import asyncio
import itertools
from dataclasses import replace

import pytest
from tests.web.fake_bridge import STATUS, FakeBridge
from tests.web.local_site import client, site

from passo.printer.status import HeaterStatus, SensorStatus
from passo.web.bridge import Snapshot
from passo.web.temperature_history import TemperatureHistory


def sample(celsius):
    heaters = {"hotend": HeaterStatus(celsius, 200.0, 0.5)}
    sensors = {"chamber": SensorStatus(celsius / 10, 0.0, 30.0)}
    return Snapshot(1, 0.0, replace(STATUS, heaters=heaters, sensors=sensors))


@pytest.fixture(scope="module")
def two_days():
    history = TemperatureHistory()
    for second in range(2 * 86400):
        history.add(sample(float(second % 300)), float(second))
    return history


def test_last_quarter_of_an_hour_has_each_second(two_days):
    times = [s.host_s for s in two_days.since(172800 - 900)]
    assert times == [float(second) for second in range(172800 - 900, 172800)]


def test_day_before_has_a_sample_each_15_s(two_days):
    times = [s.host_s for s in two_days.since(0)]
    coarse = [time for time in times if time < 172800 - 901]
    assert len(coarse) == 86400 // 15
    assert {b - a for a, b in itertools.pairwise(coarse)} == {15.0}
    assert times[0] == pytest.approx(172800 - 901 - 86400, abs=15)


def test_samples_have_temperature_target_and_power(two_days):
    (last,) = two_days.since(172799)
    assert last.heaters == {"hotend": (172799 % 300, 200.0, 0.5)}
    assert last.sensors == {"chamber": pytest.approx(172799 % 300 / 10)}


def test_recorder_samples_in_the_time_of_its_loop():
    async def run():
        history, bridge = TemperatureHistory(), FakeBridge()
        task = asyncio.create_task(history.record(bridge))
        await asyncio.sleep(0)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        return history.since(0)

    (first,) = asyncio.run(run())
    assert first.heaters["bed"] == (60.0, 60.0, 0.4)


def test_answer_has_columns_by_heater():
    bridge, history = FakeBridge(), TemperatureHistory()
    clock = asyncio.new_event_loop()
    now_s = clock.time()
    clock.close()
    history.add(bridge.latest(), now_s - 50)
    history.add(bridge.latest(), now_s - 5)
    web = client(site(bridge, temperatures=history))
    answer = web.get("/api/v1/history/temperatures", params={"span_s": 20}).json()
    assert answer["heaters"]["bed"] == {"celsius": [60.0], "target_c": [60.0], "power": [0.4]}
    assert answer["ages_s"] == [pytest.approx(5, abs=2)]
