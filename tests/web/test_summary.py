"""The summary of a printer for a page over many: small, and silent while nothing changes."""

import asyncio
from dataclasses import replace

import pytest
from starlette.websockets import WebSocketDisconnect
from tests.web.fake_bridge import STATUS, FakeBridge
from tests.web.local_site import HOST, ID, accounts, client, local_client, site
from tests.web.test_feed import Client

from passo.clock import new_loop
from passo.printer.status import FaultStatus, HeaterStatus, JobStatus, LastPrint, PrinterState
from passo.version import __version__

URL = "/api/v1/summary"
JOB = JobStatus(
    "a.gcode", 0.12345, 7, 3, None, 60.4, None, path="/hub/a.gcode", filament_mm=12.6, run="r"
)
LAST = LastPrint(3, "b.gcode", "", "failed", "it was hot")
FAULT = FaultStatus("heat.sensor-open", "heater", "the sensor is open", "Check it")


def test_summary_has_the_printer_at_a_glance():
    bridge = FakeBridge()
    web = local_client(bridge)
    idle = web.get(URL).json()
    assert idle == {
        "id": ID,
        "name": "i3",
        "version": __version__,
        "state": "idle",
        "job": None,
        "last_print": None,
        "heaters": [
            {"name": "hotend", "celsius": 25, "target_c": 0},
            {"name": "bed", "celsius": 60, "target_c": 60},
        ],
        "fault": None,
    }
    heaters = {"hotend": HeaterStatus(199.6, 200.0, 0.5), "bed": HeaterStatus(60.0, 0, 0, age_s=9)}
    bridge.show(
        replace(
            STATUS,
            state=PrinterState.HALTED,
            job=replace(JOB, left_s=99.5),
            last_print=LAST,
            heaters=heaters,
            faults=(FAULT, FAULT),
        )
    )
    found = web.get(URL).json()
    assert found["state"] == "halted"
    assert found["job"] == {
        "file": "/hub/a.gcode",
        "run": "r",
        "fraction": 0.123,
        "left_s": 100,
        "printed_s": 60,
        "layer": 3,
        "layers": None,
        "filament_mm": 13,
    }
    assert found["last_print"] == {
        "number": 3,
        "file": "b.gcode",
        "run": "",
        "result": "failed",
        "reason": "it was hot",
    }
    assert [one["celsius"] for one in found["heaters"]] == [200, None]
    assert found["fault"] == {
        "code": "heat.sensor-open",
        "part": "heater",
        "text": "the sensor is open",
        "action": "Check it",
    }


def test_news_come_at_once_and_progress_every_two_seconds():
    async def main():
        bridge = FakeBridge()
        watching = Client(site(bridge), "/api/v1/summary/feed")
        begun_s = asyncio.get_running_loop().time()
        await asyncio.sleep(0.1)
        printing = replace(STATUS, state=PrinterState.PRINTING, job=JOB)
        bridge.show(printing)  # at 0.1 s
        await asyncio.sleep(0.1)
        for i in range(20):  # from 0.2 s to 4.2 s
            bridge.show(replace(printing, job=replace(JOB, fraction=0.2 + i / 100)))
            await asyncio.sleep(0.2)
        bridge.show(replace(STATUS, last_print=LAST))  # at 4.2 s
        await asyncio.sleep(0.1)
        bridge.show(replace(STATUS, last_print=LAST, time_s=99.0, fans={"part": 1.0}))
        for noise_c in (0.6, -0.4, 0.7, -0.7):  # of sensors between two degrees
            await asyncio.sleep(10)
            heaters = {
                n: replace(h, celsius=h.celsius + noise_c) for n, h in STATUS.heaters.items()
            }
            bridge.show(replace(STATUS, last_print=LAST, heaters=heaters))
        await asyncio.sleep(600)
        await watching.leave()
        assert bridge.listeners == []
        return [(round(at_s - begun_s, 1), one) for at_s, one in watching.got]

    with asyncio.Runner(loop_factory=lambda: new_loop(None)) as runner:
        got = runner.run(main())
    assert [(at_s, one["state"]) for at_s, one in got] == [
        (0.0, "idle"),
        (0.1, "printing"),
        (2.1, "printing"),
        (4.1, "printing"),
        (4.2, "idle"),
    ]
    assert [one["job"] and one["job"]["fraction"] for _, one in got[1:]] == [
        0.123, 0.29, 0.39, None
    ]  # fmt: skip
    assert [one["last_print"] and one["last_print"]["number"] for _, one in got[-2:]] == [None, 3]


def test_feed_of_summaries_needs_a_viewer():
    kept = accounts()
    asyncio.run(kept.create_administrator("ada", "correct horse", "address", None))
    web = client(site(FakeBridge(), kept))
    with (
        pytest.raises(WebSocketDisconnect),
        web.websocket_connect(f"ws://{HOST}/api/v1/summary/feed") as feed,
    ):
        feed.receive_json()
    key = asyncio.run(kept.add_key("hub", 1))[1]
    headers = {"X-Api-Key": key}
    with web.websocket_connect(f"ws://{HOST}/api/v1/summary/feed", headers=headers) as feed:
        assert feed.receive_json()["id"] == ID
