"""The queue of prints: over HTTP, and as a live printer carries it out."""

import asyncio

from tests.web.local_site import local_client

from passo.library.printer import Printer, run

API = "/api/v1/queue"


def files(folder, *names):
    card = folder / "card"
    card.mkdir(exist_ok=True)
    for name in names:
        (card / name).write_text("G92 X0 Y0 Z0\nG1 X5 F6000\n")
    return str(card)


async def ended(printer, count):
    """The files of so many prints, when they are over."""
    found = []
    async for event in printer.events():
        if type(event).__name__ == "JobEnded":
            found.append(event.file)
            if len(found) == count:
                return found
    return None


def paths(queue):
    return [entry["path"] for entry in queue["prints"]]


def test_next_print_waits_until_the_bed_is_clear(tmp_path):
    card = files(tmp_path, "a.gcode", "b.gcode")

    async def main():
        async with Printer("i3", card=card) as printer:
            web = local_client(printer._bridge)
            for name in ("a.gcode", "b.gcode"):
                await asyncio.to_thread(web.post, API, json={"path": name})
            start = f"{API}/start"
            refused = await asyncio.to_thread(web.post, start, json={"bed_clear": False})
            over = asyncio.create_task(ended(printer, 1))
            await asyncio.sleep(0)
            await asyncio.to_thread(web.post, start, json={"bed_clear": True})
            done = await over
            await asyncio.sleep(10)
            left = (await asyncio.to_thread(web.get, API)).json()
            status = (await asyncio.to_thread(web.get, "/api/v1/status")).json()
            assert status["status"]["queue"] == left
            return refused.json()["error"]["code"], done, paths(left), printer.status.state.name

    assert run(main(), clock=100) == ("queue.bed", ["a.gcode"], ["/b.gcode"], "IDLE")


def test_automatic_queue_prints_all_and_lasts_over_a_restart(tmp_path):
    card, state = files(tmp_path, "a.gcode", "b.gcode", "c.gcode"), str(tmp_path / "state")

    async def fill():
        async with Printer("i3", card=card, state=state) as printer:
            web = local_client(printer._bridge)
            for name in ("a.gcode", "b.gcode", "c.gcode"):
                await asyncio.to_thread(web.post, API, json={"path": name})
            await asyncio.to_thread(web.put, f"{API}/prints/3/place/0")
            await asyncio.to_thread(web.delete, f"{API}/prints/1")
            await asyncio.to_thread(web.put, f"{API}/mode", json={"automatic": True})

    async def drain():
        async with Printer("i3", card=card, state=state) as printer:
            web = local_client(printer._bridge)
            kept = (await asyncio.to_thread(web.get, API)).json()
            over = asyncio.create_task(ended(printer, 2))
            await asyncio.sleep(0)
            await asyncio.to_thread(web.post, f"{API}/start", json={"bed_clear": True})
            done = await over
            left = (await asyncio.to_thread(web.get, API)).json()
            return kept["automatic"], paths(kept), done, paths(left)

    run(fill(), clock=100)
    waited = ["/c.gcode", "/b.gcode"]
    assert run(drain(), clock=100) == (True, waited, ["c.gcode", "b.gcode"], [])


def test_refusals_name_what_is_wrong(tmp_path):
    card = files(tmp_path, "a.gcode")

    async def main():
        async with Printer("i3", card=card) as printer:
            web = local_client(printer._bridge)
            answers = [
                await asyncio.to_thread(web.post, API, json={"path": "none.gcode"}),
                await asyncio.to_thread(web.delete, f"{API}/prints/7"),
                await asyncio.to_thread(web.post, f"{API}/start", json={"bed_clear": True}),
            ]
            return [(a.status_code, a.json()["error"]["code"]) for a in answers]

    assert run(main()) == [
        (404, "card.not-found"),
        (404, "queue.unknown"),
        (409, "queue.empty"),
    ]


def test_print_that_cannot_leave_the_queue_does_not_start(tmp_path):
    card, state = files(tmp_path, "a.gcode", "b.gcode"), tmp_path / "state"

    async def main():
        async with Printer("i3", card=card, state=str(state)) as printer:
            web = local_client(printer._bridge)
            for name in ("a.gcode", "b.gcode"):
                await asyncio.to_thread(web.post, API, json={"path": name})
            await asyncio.to_thread(web.put, f"{API}/prints/1/place/{10**30}")
            (state / "queue.json").unlink()
            (state / "queue.json").mkdir()  # which no file replaces
            start = await asyncio.to_thread(web.post, f"{API}/start", json={"bed_clear": True})
            left = (await asyncio.to_thread(web.get, API)).json()
            return start.json()["error"]["code"], paths(left), printer.status.state.name

    waiting = ["/b.gcode", "/a.gcode"]
    assert run(main(), clock=100) == ("queue.unwritable", waiting, "IDLE")
