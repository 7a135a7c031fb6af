"""Faults of the simulated printer over HTTP."""

import asyncio

from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import local_client

from passo.library.printer import Printer, run

API = "/api/v1/simulation/parts"


def test_part_gets_a_fault_and_loses_it():
    async def main():
        async with Printer("i3") as printer:
            web = local_client(printer._bridge)
            return await asyncio.to_thread(asked, web)

    def asked(web):
        assert web.put(f"{API}/x-endstop", json={"fault": "triggered"}).status_code == 204
        first = {one["part"]: one for one in web.get(API).json()}
        assert web.put(f"{API}/x-endstop", json={"fault": "none"}).status_code == 204
        second = {one["part"]: one for one in web.get(API).json()}
        refused = web.put(f"{API}/x-endstop", json={"fault": "melted"})
        return first["x-endstop"], second["x-endstop"], refused.json()

    first, second, refused = run(main())
    assert first == {
        "part": "x-endstop",
        "faults": ["none", "triggered", "open"],
        "active": "triggered",
    }
    assert second["active"] == "none"
    assert refused["error"]["code"] == "command.no-fault"


def test_nothing_but_names_gets_into_a_command():
    bridge = FakeBridge()
    web = local_client(bridge)
    assert web.put(f"{API}/cable%0AM112", json={"fault": "cut"}).status_code in (400, 404)
    assert web.put(f"{API}/cable", json={"fault": "cut\nM112"}).status_code == 400
    assert bridge.asked == []
