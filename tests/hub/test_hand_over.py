"""A run is handed over to its printer once, whatever is lost on the way."""

from __future__ import annotations

import asyncio

import pytest
from tests.support.fake_printer import FakePrinter, Network
from tests.support.farm_world import World, play

from passo.errors import HubError
from passo.hub.wishes import PrinterChange

START = 1  # the number of the request that starts the first run; the upload is 0


async def one_printer(printer: FakePrinter, **job: object) -> World:
    """A farm of one printer, with a clear bed and a job."""
    world = World([printer])
    await world.start()
    await world.job(**job)
    await world.clear()
    return world


def bad_network(world: World, request: int, **network: float) -> None:
    """The network fails at one request."""

    def at_link(number: int, answered: bool) -> None:
        if not answered:
            now = Network(**network) if number == request else Network()
            vars(world.network).update(vars(now))

    world.at_link = at_link


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


@pytest.mark.parametrize(
    ("network", "asked"),
    [({"lost": 1.0}, 1), ({"unanswered": 1.0}, 1), ({"late": 1.0, "late_s": 20.0}, 1)],
    ids=["request", "answer", "late request"],
)
def test_lost_start_is_asked_about_and_starts_once(network, asked):
    async def test():
        printer = FakePrinter("mk3")
        world = await one_printer(printer)
        bad_network(world, START, **network)
        await asyncio.sleep(3000)
        assert list(world.states().values()) == ["done"]
        assert [start.run for start in printer.starts] == list(world.states())
        sent = printer.users.count("anna")
        assert sent == (1 if "unanswered" in network else 2)
        assert world.link_calls == 2 + asked + sent - 1

    play(test)


def test_start_that_arrives_after_its_run_was_cancelled_is_ended():
    async def test():
        printer = FakePrinter("mk3")
        world = await one_printer(printer)
        bad_network(world, START, late=1.0, late_s=60.0)
        await asyncio.sleep(8.0)
        await world.farm.cancel(printer.id, "bert")
        await asyncio.sleep(30.0)
        assert (list(world.states().values()), printer.starts) == (["cancelled"], [])
        await asyncio.sleep(60.0)
        assert len(printer.starts) == printer.cancels == 1
        assert printer.users[-1] == "bert"
        assert not world.shown(printer).bed_clear
        assert world.farm.view().jobs == ()

    play(test)


@pytest.mark.parametrize("away_s", [60.0, 300.0], ids=["prints", "has printed"])
def test_lost_start_is_not_repeated_after_a_print_by_hand(away_s):
    async def test():
        printer = FakePrinter("mk3", print_s=200.0)
        world = await one_printer(printer)
        bad_network(world, START, lost=1.0)
        await asyncio.sleep(6.0)
        printer.reachable = False
        printer.disconnect()
        printer.print_by_hand()
        await asyncio.sleep(away_s)
        printer.reachable = True
        await asyncio.sleep(60.0)
        (run,) = await world.farm.runs(10, "", "")
        assert (run.state, printer.starts) == ("cancelled", [])
        assert "has not received the start" in run.reason
        shown = world.shown(printer)
        assert (shown.attention, shown.bed_clear) == ("", False)
        assert world.farm.view().jobs[0].waiting == 1

    play(test)


@pytest.mark.parametrize("wish", ["stop", "service"])
def test_lost_start_is_not_repeated_after_a_users_wish(wish):
    async def test():
        printer = FakePrinter("mk3")
        world = await one_printer(printer)
        bad_network(world, START, lost=1.0)
        await asyncio.sleep(6.0)
        printer.reachable = False
        printer.disconnect()
        if wish == "stop":
            (stopped,) = await world.farm.stop([printer.id], "anna")
            assert stopped.result == "unreachable"
        else:
            await world.farm.change_printer(printer.id, PrinterChange(service=True), "anna")
        printer.reachable = True
        await asyncio.sleep(60.0)
        assert (list(world.states().values()), printer.starts) == (["cancelled"], [])

    play(test)


@pytest.mark.parametrize("started", [True, False])
def test_user_says_if_a_printer_without_run_ids_has_started(started):
    async def test():
        printer = FakePrinter("ender", knows_runs=False)
        world = await one_printer(printer)
        bad_network(world, START, **({"unanswered": 1.0} if started else {"lost": 1.0}))
        await asyncio.sleep(60.0)
        shown = world.shown(printer)
        assert shown.start_unknown and "Nobody knows whether part.gcode" in shown.attention
        assert len(printer.starts) == started
        await asyncio.sleep(600.0)
        with pytest.raises(HubError, match="Say which"):
            await world.farm.attend(printer.id, None, "bert")
        shown = await world.farm.attend(printer.id, started, "bert")
        assert not shown.start_unknown and not shown.attention
        if started:
            await asyncio.sleep(3000.0)
            assert list(world.states().values()) == ["done"]
        else:
            assert list(world.states().values()) == ["cancelled"]
            assert world.farm.view().jobs[0].waiting == 1
            await world.clear()
            await asyncio.sleep(3000.0)
            assert list(world.states().values()) == ["cancelled", "done"]
        assert len(printer.starts) == 1

    play(test)


def test_print_by_hand_before_the_start_sends_the_run_elsewhere():
    async def test():
        first, second = FakePrinter("a"), FakePrinter("b")
        world = World([first, second], network=Network(upload_s=60.0))
        await world.start()
        await world.clear()
        await world.job()
        await asyncio.sleep(30.0)
        assert world.shown(first).run
        first.print_by_hand()
        await asyncio.sleep(100.0)
        assert (first.starts, len(second.starts)) == ([], 1)
        assert not world.shown(first).bed_clear
        runs = await world.farm.runs(10, first.id, "")
        assert [(run.state, run.reason) for run in runs] == [("cancelled", "printing")]

    play(test)


@pytest.mark.parametrize("hub", ["connected", "killed", "printer away"])
def test_print_by_hand_makes_the_bed_unclear(hub):
    async def test():
        printer = FakePrinter("mk3", print_s=100.0)
        world = World([printer])
        await world.start()
        await world.clear()
        assert world.shown(printer).bed_clear
        if hub == "killed":
            world.disk.dead = True
        elif hub == "printer away":
            printer.reachable = False
            printer.disconnect()
        printer.print_by_hand()
        await asyncio.sleep(200.0)
        printer.reachable = True
        if hub == "killed":
            await world.restart()
        await world.job()
        await asyncio.sleep(120.0)
        shown = world.shown(printer)
        assert (shown.condition, shown.bed_clear, printer.starts) == ("idle", False, [])
        assert world.farm.view().jobs[0].why == "No printer is free: bed not cleared (1)"

    play(test)


def test_printer_that_ejects_its_prints_needs_no_user():
    async def test():
        printer = FakePrinter("belt", clears_itself=True)
        world = World([printer])
        await world.start()
        await world.farm.change_printer(printer.id, PrinterChange(clears_itself=True), "admin")
        await world.clear()
        await world.job(quantity=3)
        await asyncio.sleep(4500)
        assert len(printer.starts) == 3
        printer.cancel()  # what is left of this print, nobody knows
        await asyncio.sleep(3600)
        assert list(world.states().values()) == ["done", "done", "cancelled"]
        assert not world.shown(printer).bed_clear

    play(test)


def test_unreachable_printer_is_never_idle():
    async def test():
        first, second = FakePrinter("a"), FakePrinter("b")
        world = World([first, second], network=Network(upload_s=60.0))
        await world.start()
        await world.clear(first)
        await world.job()
        await asyncio.sleep(10.0)
        first.freeze()
        await asyncio.sleep(61.0)
        shown = world.shown(first)
        assert shown.condition == "unreachable"
        assert shown.last_word_s == pytest.approx(world.wall_s() - 31.0, abs=1.5)
        (job,) = world.farm.view().jobs
        assert (job.waiting, job.running) == (1, 0)  # another printer may take it
        assert job.why == "No printer is free: bed not cleared (1), unreachable (1)"
        with pytest.raises(HubError, match="a is unreachable"):
            await world.farm.clear(first.id, "anna")
        await world.clear(second)
        await asyncio.sleep(200.0)
        first.thaw()
        await asyncio.sleep(60.0)
        assert (first.starts, len(second.starts)) == ([], 1)
        assert world.shown(first).condition == "idle"

    play(test)


def test_failed_print_is_repeated_on_another_printer_first():
    async def test():
        a, b = FakePrinter("a"), FakePrinter("b")
        world = World([a, b])
        await world.start()
        await world.clear(a)
        await world.job(retries=1)
        await asyncio.sleep(100.0)
        a.halt("Hotend 150 °C below its target of 210 °C")
        await asyncio.sleep(1.0)
        shown = world.shown(a)
        assert shown.condition == "halted" and not shown.bed_clear
        assert shown.attention == "Hotend 150 °C below its target of 210 °C"
        a.restart()
        await world.farm.attend(a.id, None, "anna")
        await asyncio.sleep(10.0)
        assert world.farm.view().jobs[0].waiting == 1  # nobody has cleared a bed
        await world.farm.pause_queue(True, "anna")
        await world.clear(a, b)
        await world.farm.pause_queue(False, "anna")
        await asyncio.sleep(100.0)
        assert (len(a.starts), len(b.starts)) == (1, 1)
        b.halt("Again")
        await asyncio.sleep(5.0)
        assert world.farm.view().jobs == ()  # no retry is left
        runs = await world.farm.runs(10, "", "")
        assert [(run.state, run.attempt, run.reason) for run in runs] == [
            ("failed", 2, "Again"),
            ("failed", 1, "Hotend 150 °C below its target of 210 °C"),
        ]

    play(test)


def test_lost_content_of_a_file_fails_the_run(tmp_path):
    async def test():
        world = World([FakePrinter("mk3")])
        world.contents = tmp_path
        await world.start()
        await world.clear()
        await world.job()
        await asyncio.sleep(10.0)
        (run,) = await world.farm.runs(10, "", "")
        assert (run.state, run.reason) == ("failed", "The hub has lost part.gcode")

    play(test)


@pytest.mark.parametrize("what", ["upload", "start"])
def test_refusal_of_a_printer_fails_the_run(what):
    async def test():
        printer = FakePrinter("mk3")
        world = World([printer])
        await world.start()
        printer.full, printer.refuses_start = what == "upload", what == "start"
        await world.clear()
        await world.job()
        await asyncio.sleep(60.0)
        (run,) = await world.farm.runs(10, "", "")
        reason = {
            "upload": "The upload failed: The card is full",
            "start": "The start was refused: mk3 is idle",
        }[what]
        assert (run.state, run.reason) == ("failed", reason)
        assert world.shown(printer).attention == reason
        assert world.shown(printer).bed_clear is (what == "upload")

    play(test)


@pytest.mark.parametrize("after_s", [2.0, 7.0, 5.06, 60.0], ids=str)
def test_cancelled_job_cancels_its_runs(after_s):
    async def test():
        printer = FakePrinter("mk3")
        world = await one_printer(printer, quantity=3)
        await asyncio.sleep(after_s)
        (job,) = world.store.jobs
        await world.farm.cancel_job(job, "boss")
        await asyncio.sleep(60.0)
        assert list(world.states().values()) == ["cancelled"]
        assert world.farm.view().jobs == ()
        assert printer.job is None and printer.cancels == len(printer.starts)
        assert "boss" in printer.users or not printer.starts

    play(test)


def test_wish_to_cancel_waits_for_an_unreachable_printer():
    async def test():
        printer = FakePrinter("mk3")
        world = await one_printer(printer)
        await asyncio.sleep(60.0)
        printer.reachable = False
        printer.disconnect()
        await world.farm.cancel(printer.id, "boss")
        await asyncio.sleep(100.0)
        await world.restart()
        assert list(world.states().values()) == ["printing"]
        printer.reachable = True
        await asyncio.sleep(100.0)
        assert list(world.states().values()) == ["cancelled"]
        assert printer.cancels == 1 and printer.users[-1] == "boss"

    play(test)


def test_lost_cancel_is_sent_again():
    async def test():
        printer = FakePrinter("mk3")
        world = await one_printer(printer)
        await asyncio.sleep(60.0)
        world.network.lost = 1.0
        await world.farm.cancel(printer.id, "boss")
        await asyncio.sleep(5.0)
        world.network.lost = 0.0
        await asyncio.sleep(30.0)
        assert printer.users == ["anna", "boss", "boss"]
        assert (list(world.states().values()), printer.cancels) == (["cancelled"], 1)

    play(test)


def test_full_disk_of_the_hub_starts_nothing():
    async def test():
        printer = FakePrinter("mk3")
        world = await one_printer(printer)
        await asyncio.sleep(2.0)
        world.disk.full = True
        await asyncio.sleep(100.0)
        assert printer.starts == []
        with pytest.raises(HubError, match="disk is full"):
            await world.job("other.gcode")
        world.disk.full = False
        await asyncio.sleep(3000.0)
        assert list(world.states().values()) == ["done"]
        assert len(printer.starts) == 1

    play(test)


def test_print_that_ends_while_the_hub_is_away_is_done():
    async def test():
        printer = FakePrinter("mk3")
        world = await one_printer(printer)
        await asyncio.sleep(60.0)
        world.disk.dead = True
        await asyncio.sleep(3600.0)
        printer.print_by_hand()  # the newest print is another one
        await world.restart()
        await asyncio.sleep(20.0)
        assert list(world.states().values()) == ["done"]
        assert world.farm.view().jobs == ()

    play(test)


def test_printer_that_has_lost_its_memory_fails_the_run():
    async def test():
        printer = FakePrinter("mk3")
        world = await one_printer(printer)
        await asyncio.sleep(60.0)
        printer.runs.clear()
        printer.job.run = ""
        printer.power_cut()
        await asyncio.sleep(60.0)
        (run,) = await world.farm.runs(10, "", "")
        assert run.state == "failed" and "does not know this run" in run.reason
        assert world.shown(printer).attention == run.reason

    play(test)


@pytest.mark.parametrize("at_s", [5.2, 60.0], ids=["starting", "printing"])
def test_user_gives_up_the_run_of_a_printer_that_is_gone(at_s):
    async def test():
        printer = FakePrinter("mk3")
        world = await one_printer(printer, retries=1)
        bad_network(world, START if at_s < 10 else -1, lost=1.0)
        await asyncio.sleep(at_s)
        printer.reachable = False
        printer.disconnect()
        await asyncio.sleep(100.0)
        with pytest.raises(HubError, match="at work"):
            await world.farm.remove_printer(printer.id, "admin")
        await world.farm.attend(printer.id, False, "anna")
        assert world.farm.view().jobs[0].waiting == 1
        await world.farm.remove_printer(printer.id, "admin")
        assert world.farm.view().jobs[0].why == "The farm has no printers"

    play(test)


def test_new_address_connects_again_and_keeps_the_run():
    async def test():
        printer = FakePrinter("mk3")
        world = await one_printer(printer)
        await asyncio.sleep(60.0)
        change = PrinterChange(url="http://10.0.0.7:4000")
        assert (await world.farm.change_printer(printer.id, change, "admin")).run
        await asyncio.sleep(30.0)
        assert world.shown(printer).condition == "printing"
        assert len(printer.lines) == 1
        await asyncio.sleep(3000.0)
        assert list(world.states().values()) == ["done"]
        assert len(printer.starts) == 1

    play(test)


def test_print_of_a_printer_without_run_ids_is_followed_by_its_file():
    async def test():
        printer = FakePrinter("ender", knows_runs=False, clears_itself=True)
        world = World([printer])
        await world.start()
        await world.farm.change_printer(printer.id, PrinterChange(clears_itself=True), "admin")
        await world.clear()
        await world.job(quantity=2)
        await asyncio.sleep(60.0)
        world.disk.dead = True
        await asyncio.sleep(60.0)
        await world.restart()
        await asyncio.sleep(4000.0)
        assert list(world.states().values()) == ["done", "done"]
        runs = await world.farm.runs(10, "", "")
        assert [run.printed_s > 100.0 for run in runs] == [True, True]

    play(test)
