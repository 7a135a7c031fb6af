"""A run is handed over to its printer once, whatever is lost on the way."""

from __future__ import annotations

import asyncio

from tests.support.fake_printer import FakePrinter
from tests.support.farm_world import World, play


def test_job_prints_on_a_cleared_printer_and_ends():
    async def test():
        printer = FakePrinter("mk3")
        world = World([printer])
        await world.start()
        job = await world.job(quantity=2)
        assert (job.waiting, job.why) == (2, "No printer is free: bed not cleared (1)")
        await world.clear()
        await asyncio.sleep(60)
        (shown,) = world.farm.view().jobs
        assert (shown.waiting, shown.running, shown.done) == (1, 1, 0)
        assert world.shown(printer).condition == "printing"
        assert not world.shown(printer).bed_clear
        await asyncio.sleep(3600)
        assert len(printer.starts) == 1  # nothing more until the bed is cleared
        await world.clear()
        await asyncio.sleep(3600)
        assert world.farm.view().jobs == ()
        assert list(world.states().values()) == ["done", "done"]
        assert [start.occupied for start in printer.starts] == [False, False]
        assert printer.users == ["anna", "anna"]

    play(test)
