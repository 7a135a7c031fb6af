"""What users ask of the farm, and what it shows."""

from __future__ import annotations

import asyncio
from itertools import pairwise

import pytest
from tests.support.fake_printer import FakePrinter
from tests.support.farm_world import USER, World, play

from passo.errors import HubError, WebError
from passo.hub.link import PrinterRecord
from passo.hub.matching import Fit
from passo.hub.views import Loaded
from passo.hub.wishes import JobChange, PrinterChange, ServiceInterval, Stopped


async def farm(*names: str, clear: bool = True, **options: object) -> World:
    """A farm of printers with clear beds."""
    world = World([FakePrinter(name, **options) for name in names])
    await world.start()
    if clear:
        await world.clear()
    return world


def starts(world: World) -> dict[str, int]:
    return {printer.name: len(printer.starts) for printer in world.printers.values()}


def test_one_file_goes_to_each_chosen_printer_once():
    async def test():
        world = await farm("a", "b", "c", "d", "e", "f")
        await world.job(each=["id-a", "id-c", "id-d", "id-e", "id-f"])
        await asyncio.sleep(60.0)
        assert starts(world) == {"a": 1, "b": 0, "c": 1, "d": 1, "e": 1, "f": 1}
        await asyncio.sleep(3600.0)
        assert world.farm.view().jobs == ()

    play(test)


def test_urgent_job_comes_first_and_a_paused_one_not_at_all():
    async def test():
        world = await farm("a", clear=False)
        jobs = [
            await world.job("low.gcode"),
            await world.job("due.gcode", due_s=world.wall_s() + 60.0),
            await world.job("high.gcode", priority=5),
            await world.job("paused.gcode", priority=9),
        ]
        await world.farm.change_job(jobs[3].id, JobChange(paused=True), USER)
        for name in ("high.gcode", "due.gcode", "low.gcode"):
            await world.clear()
            await asyncio.sleep(3600.0)
            assert (await world.farm.runs(1, "", ""))[0].name == name
        await world.clear()
        await asyncio.sleep(60.0)
        (left,) = world.farm.view().jobs
        assert (left.name, left.why) == ("paused.gcode", "The job is paused")

    play(test)


def test_paused_queue_keeps_an_uploaded_run_from_starting():
    async def test():
        world = await farm("a")
        job = await world.job()
        await asyncio.sleep(2.0)
        await world.farm.pause_queue(True, USER)
        await asyncio.sleep(100.0)
        assert (list(world.states().values()), starts(world)) == (["uploaded"], {"a": 0})
        await world.farm.change_job(job.id, JobChange(paused=True), USER)
        await world.farm.pause_queue(False, USER)
        await asyncio.sleep(100.0)
        assert (list(world.states().values()), starts(world)) == (["cancelled"], {"a": 0})
        await world.farm.change_job(job.id, JobChange(paused=False), USER)
        await asyncio.sleep(100.0)
        assert starts(world) == {"a": 1}

    play(test)


def test_heaters_of_a_power_group_warm_up_one_after_the_other():
    async def test():
        world = await farm("a", "b", "c", heat_s=100.0)
        await world.farm.set_power_group("fuse", 500.0, "admin")
        for id in world.printers:
            change = PrinterChange(power_group="fuse", heating_w=300.0)
            await world.farm.change_printer(id, change, "admin")
        await world.job(quantity=3)
        await asyncio.sleep(30.0)
        assert world.farm.view().groups[0].used_w == 300.0
        await asyncio.sleep(370.0)
        at = [at_s for at_s, _, _ in world.starts()]
        assert len(at) == 3
        assert [b - a for a, b in pairwise(at)] == pytest.approx([100, 100], abs=1)

    play(test)


def test_unreachable_printer_of_a_power_group_counts_as_heating():
    async def test():
        world = await farm("a", "b")
        await world.farm.set_power_group("fuse", 500.0, "admin")
        for id in world.printers:
            change = PrinterChange(power_group="fuse", heating_w=300.0)
            await world.farm.change_printer(id, change, "admin")
        a = world.printers["id-a"]
        a.reachable = False
        a.disconnect()
        await world.job()
        await asyncio.sleep(600.0)
        assert starts(world) == {"a": 0, "b": 0}
        a.reachable = True
        await asyncio.sleep(60.0)
        assert starts(world) in ({"a": 1, "b": 0}, {"a": 0, "b": 1})

    play(test)


def test_power_group_refuses_a_printer_that_exceeds_it():
    async def test():
        world = await farm("a")
        await world.farm.set_power_group("fuse", 250.0, "admin")
        change = PrinterChange(power_group="fuse", heating_w=300.0)
        with pytest.raises(HubError, match=r"a takes 300 W.*allows 250 W"):
            await world.farm.change_printer("id-a", change, "admin")
        with pytest.raises(WebError, match="power group none"):
            await world.farm.change_printer("id-a", PrinterChange(power_group="none"), "admin")
        await world.farm.set_power_group("fuse", 300.0, "admin")
        assert (await world.farm.change_printer("id-a", change, "admin")).heating_w == 300.0
        with pytest.raises(HubError, match=r"a takes 300 W.*allows 299 W"):
            await world.farm.set_power_group("fuse", 299.0, "admin")
        await world.farm.remove_power_group("fuse", "admin")
        assert world.farm.printer("id-a").power_group == ""
        assert world.farm.view().groups == ()

    play(test)


@pytest.mark.parametrize(
    ("printer", "job", "why"),
    [
        ({"loaded": Loaded("PETG")}, {"needs": Loaded("PLA")}, "material PLA is not loaded"),
        ({"loaded": Loaded("pla", "blue")}, {"needs": Loaded("PLA", "red")}, "colour red"),
        ({"loaded": Loaded("PLA", "blue")}, {"needs": Loaded("pla")}, ""),
        ({"loaded": Loaded(nozzle_mm=0.6)}, {"needs": Loaded(nozzle_mm=0.4)}, "not 0.4 mm"),
        ({"loaded": Loaded()}, {"needs": Loaded(plate="rough")}, "plate rough is not loaded"),
        ({"tags": ["hall 1"]}, {"tags": ["hall 2"]}, "tag hall 2 is missing"),
        ({"tags": ["hall 1", "big"]}, {"tags": ["big"]}, ""),
        ({"service": True}, {}, "in service"),
    ],
)
def test_job_waits_for_a_printer_that_suits(printer, job, why):
    async def test():
        world = await farm("a")
        await world.farm.change_printer("id-a", PrinterChange(**printer), "admin")
        await world.job(**job)
        await asyncio.sleep(60.0)
        (shown,) = world.farm.view().jobs
        assert why in shown.why and bool(shown.why) is bool(why)
        assert starts(world) == {"a": int(not why)}

    play(test)


@pytest.mark.parametrize(
    ("file", "why"),
    [
        ({"materials": ("PETG",)}, "the file is for PETG"),
        ({"materials": ("PLA", "PLA")}, ""),
        ({"nozzle_mm": 0.6}, "the file is for 0.6 mm"),
    ],
)
def test_file_for_another_material_or_nozzle_waits(file, why):
    async def test():
        world = await farm("a")
        loaded = PrinterChange(loaded=Loaded("PLA", nozzle_mm=0.4))
        await world.farm.change_printer("id-a", loaded, USER)
        await world.file(**file)
        job = await world.job()
        assert why in job.why and bool(job.why) is bool(why)
        # A user may want it all the same.
        needs = JobChange(needs=Loaded("PLA", nozzle_mm=0.4))
        await world.farm.change_job(job.id, needs, USER)
        await asyncio.sleep(60.0)
        assert starts(world) == {"a": 1}

    play(test)


def test_file_waits_for_its_check_and_goes_where_it_fits():
    async def test():
        fits = {}
        world = World([FakePrinter("a"), FakePrinter("b")], fits=lambda _, id: fits.get(id))
        await world.start()
        await world.clear()
        await world.job()
        await asyncio.sleep(60.0)
        (job,) = world.farm.view().jobs
        assert job.why == "No printer suits: its check is not finished (2)"
        fits |= {"id-a": Fit(False, "Y 235 mm is outside 0 to 220 mm"), "id-b": Fit(True)}
        world.farm.refit()
        await asyncio.sleep(60.0)
        assert starts(world) == {"a": 0, "b": 1}

    play(test)


def test_stop_reaches_all_printers_and_nothing_starts_after_it():
    async def test():
        world = await farm("a", "b", "c")
        world.printers["id-b"].reachable = False
        await world.job(quantity=1)
        await asyncio.sleep(60.0)
        stopped = await world.farm.stop(list(world.printers), "boss")
        assert stopped == [
            Stopped("id-a", "done"),
            Stopped("id-b", "unreachable", "no answer"),
            Stopped("id-c", "done"),
        ]
        assert [printer.stops for printer in world.printers.values()] == [1, 0, 1]
        assert world.printers["id-c"].users == ["boss"]
        await world.job(quantity=3)
        for printer in world.printers.values():
            printer.reachable = True
            printer.restart()
        await asyncio.sleep(100.0)
        assert sum(starts(world).values()) == 1
        assert world.farm.view().jobs[0].why == "No printer is free: needs attention (3)"

    play(test)


def test_stop_works_although_the_disk_is_full():
    async def test():
        world = await farm("a")
        world.disk.full = True
        with pytest.raises(HubError, match="disk is full"):
            await world.farm.stop(["id-a"], "boss")
        assert world.printers["id-a"].stops == 1

    play(test)


def test_commands_name_the_user_and_answers_of_the_printer():
    async def test():
        world = await farm("a")
        await world.job()
        await asyncio.sleep(60.0)
        with pytest.raises(HubError, match=r"a refuses: Nothing is paused\. Start a print\."):
            await world.farm.resume("id-a", "bert")
        await world.farm.pause("id-a", "bert")
        await asyncio.sleep(1.0)
        assert world.farm.printer("id-a").condition == "paused"
        await world.farm.resume("id-a", "carl")
        await world.farm.cancel("id-a", "dora")
        await asyncio.sleep(5.0)
        assert list(world.states().values()) == ["cancelled"]
        assert world.printers["id-a"].users == ["anna", "bert", "bert", "carl", "dora"]
        world.printers["id-a"].reachable = False
        with pytest.raises(HubError, match="a does not answer: no answer"):
            await world.farm.pause("id-a", "bert")
        with pytest.raises(WebError, match="printer id-z"):
            await world.farm.pause("id-z", "bert")

    play(test)


def test_removals_that_would_lose_something_are_refused():
    async def test():
        world = await farm("a", "b")
        job = await world.job()
        await asyncio.sleep(60.0)
        with pytest.raises(HubError, match=r"part\.gcode is needed by 1 jobs"):
            await world.farm.remove_file(job.file, USER)
        with pytest.raises(HubError, match=r"a is at work on part\.gcode"):
            await world.farm.remove_printer("id-a", "admin")
        with pytest.raises(HubError, match=r"a is printing"):
            await world.farm.clear("id-a", USER)
        record = PrinterRecord("id-a", "again", "http://a", "passo", "key")
        with pytest.raises(HubError, match="again is in the farm already, as a"):
            await world.farm.add_printer(record, (), "admin")
        await world.farm.remove_printer("id-b", "admin")
        await asyncio.sleep(3600.0)
        await world.farm.remove_file(job.file, USER)
        await world.farm.remove_printer("id-a", "admin")
        assert (world.farm.view().printers, world.farm.files()) == ((), [])
        assert [run.state for run in await world.farm.runs(10, "", "")] == ["done"]

    play(test)


def test_quantity_can_grow_and_shrink_to_what_has_begun():
    async def test():
        world = await farm("a", "b")
        job = await world.job(quantity=5)
        await asyncio.sleep(60.0)
        with pytest.raises(HubError, match="begun 2 times"):
            await world.farm.change_job(job.id, JobChange(quantity=1), USER)
        await world.farm.change_job(job.id, JobChange(quantity=2), USER)
        await asyncio.sleep(3600.0)
        assert world.farm.view().jobs == ()
        with pytest.raises(WebError, match="open job"):
            await world.farm.change_job(job.id, JobChange(quantity=3), USER)

    play(test)


def test_totals_are_by_printer_material_and_user():
    async def test():
        world = await farm("a", "b", heat_s=100.0, print_s=1000.0)
        await world.farm.change_printer("id-a", PrinterChange(loaded=Loaded("PLA")), USER)
        await world.job("one.gcode", "anna", needs=Loaded("PLA"))
        await asyncio.sleep(500.0)
        await world.job("two.gcode", "bert")
        await asyncio.sleep(200.0)
        world.printers["id-b"].halt("A fault")
        await asyncio.sleep(1000.0)
        found = await world.farm.statistics()
        assert (found.done, found.failed, found.cancelled) == (1, 1, 0)
        assert [(row.printer, row.done, row.failed) for row in found.printers] == [
            ("id-a", 1, 0),
            ("id-b", 0, 1),
        ]
        assert [(row.name, row.done, row.failed) for row in found.materials] == [
            ("", 0, 1),
            ("PLA", 1, 0),
        ]
        assert [(row.name, row.done) for row in found.users] == [("anna", 1), ("bert", 0)]
        lines = [(line.who, line.what) for line in await world.farm.events(4)]
        assert ("hub", "The print on b is failed: A fault") in lines
        assert ("hub", "Job 2 is over: 1 failed") in lines

    play(test)


def test_maintenance_item_is_due_after_prints_and_done_by_a_user():
    async def test():
        world = await farm("a", print_s=1000.0)
        interval = ServiceInterval(every_prints=2, every_h=100.0)
        item = await world.farm.set_service_item("id-a", "grease", interval, "anna")
        assert (item.prints, item.due, item.done_s) == (0, False, None)
        for due in ((), ("grease",)):
            await world.job()
            await asyncio.sleep(1100.0)
            assert world.farm.printer("id-a").service_due == due
            await world.clear()
        (item,) = await world.farm.service_items("id-a")
        assert (item.prints, item.due) == (2, True)
        interval = ServiceInterval(every_prints=2, done=True)
        item = await world.farm.set_service_item("id-a", "grease", interval, "bert")
        assert (item.prints, item.due, item.done_by) == (0, False, "bert")
        assert item.done_s == world.wall_s()
        await world.restart()
        (again,) = await world.farm.service_items("id-a")
        assert again == item
        await world.farm.remove_service_item("id-a", "grease", "bert")
        assert await world.farm.service_items("id-a") == []

    play(test)


def test_listeners_learn_of_changes_until_they_end():
    async def test():
        world = await farm("a")
        calls = []
        end = world.farm.listen(lambda: calls.append(world.farm.view().queue_paused))
        await world.farm.pause_queue(True, USER)
        await asyncio.sleep(0.1)
        assert calls == [True]
        end()
        await world.farm.pause_queue(False, USER)
        await asyncio.sleep(0.1)
        assert calls == [True]

    play(test)


def test_200_printers_connect_20_at_a_time_within_30_s():
    async def test():
        world = World([FakePrinter(f"p{i}") for i in range(200)])
        await world.farm.start()
        for printer in list(world.printers.values()):
            await world.add(printer)
        world.network.delay_s = 1.0
        await world.restart()
        world.network.most_connecting = 0
        await asyncio.sleep(30.0)
        seen = [printer.condition for printer in world.farm.view().printers]
        assert seen == ["idle"] * 200
        assert 10 < world.network.most_connecting <= 20

    play(test)
