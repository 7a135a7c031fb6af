"""Life on a farm at random: users who clear beds and add jobs, faults of printers and networks; and
what must hold whatever happens, as the printers see it."""

from __future__ import annotations

import asyncio
import sqlite3
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from random import Random

from tests.support.fake_printer import FakePrinter
from tests.support.farm_world import Killed, World

from passo.errors import PassoError
from passo.hub.run_state import RunState
from passo.hub.store import JOBS, RUNS
from passo.hub.wishes import PrinterChange

FAULTS = ("halt", "power cut", "by hand", "by hand", "disconnect", "freeze", "off", "cancel")
FAULTS += ("pause", "refuse", "full", "user cancels", "user cancels job", "kill", "queue", "stop")


class Life:
    """Users and faults, from one seed. `limit_w` is the limit of each power group."""

    def __init__(self, world: World, seed: int, limits_w: dict[str, float]) -> None:
        self.world, self.chance, self.limits_w = world, Random(f"life {seed}"), limits_w
        self.violations: list[str] = []
        self.calm = False
        self.groups: dict[str, tuple[str, float]] = {}  # of printers: group, W
        self.did: Counter[str] = Counter()
        self.seen: Counter[str] = Counter()
        for printer in world.printers.values():
            printer.begins = self._begins

    async def set_power(self, printer: FakePrinter, group: str, heating_w: float) -> None:
        """Puts a printer into a power group."""
        farm = self.world.farm
        if group not in self.world.store.groups:
            await farm.set_power_group(group, self.limits_w[group], "admin")
        change = PrinterChange(power_group=group, heating_w=heating_w)
        await farm.change_printer(printer.id, change, "admin")
        self.groups[printer.id] = group, heating_w

    async def users(self, every_s: float, until_s: float) -> None:
        """Users look at the printers from time to time, until all jobs are over, at most until
        `until_s`."""
        loop = asyncio.get_running_loop()
        while loop.time() < until_s:
            await asyncio.sleep(self.chance.uniform(0.5, 1.5) * every_s)
            for printer in list(self.world.printers.values()):
                if self.calm or self.chance.random() < 0.8:
                    await self.asked(self._look_after, printer)
            if self.calm and not self.world.killed.is_set() and not self.world.store.jobs:
                return

    async def faults(self, every_s: float, until_s: float) -> None:
        """Printers, networks and the hub fail from time to time; then comes the calm."""
        loop = asyncio.get_running_loop()
        while loop.time() < until_s:
            await asyncio.sleep(self.chance.expovariate(1 / every_s))
            await self._fail(self.chance.choice(list(self.world.printers.values())))
        self.calm = True
        self.world.network.lost = self.world.network.unanswered = self.world.network.late = 0.0
        for printer in self.world.printers.values():
            printer.reachable, printer.refuses_start, printer.full = True, False, False
            printer.thaw()

    async def hub(self) -> None:
        """Starts the hub again after each kill."""
        while True:
            await self.world.killed.wait()
            await asyncio.sleep(self.chance.choice((0.0, 5.0, 90.0)))
            await self.world.restart()

    async def _fail(self, printer: FakePrinter) -> None:
        loop, chance = asyncio.get_running_loop(), self.chance
        what = chance.choice(FAULTS)
        self.did[what] += 1
        for_s = chance.choice((5.0, 50.0, 400.0))
        if what == "halt" and printer.state != "halted":
            printer.halt("The hotend does not heat")
        elif what == "power cut":
            printer.power_cut()
        elif what == "by hand":
            # Users print where a bed is empty, also while the hub believes it free.
            for one in self.world.printers.values():
                if one.state == "idle" and not one.on_bed:
                    one.print_by_hand()
                    break
        elif what == "disconnect":
            printer.disconnect()
        elif what == "freeze":
            printer.freeze()
            loop.call_later(for_s, printer.thaw)
        elif what == "off":
            printer.reachable = False
            printer.disconnect()
            loop.call_later(for_s, setattr, printer, "reachable", True)
        elif what == "cancel" and printer.job is not None:
            printer.cancel()
        elif what == "pause" and printer.state == "printing":
            printer.pause()
            loop.call_later(for_s, self._resume, printer)
        elif what in ("refuse", "full"):
            name = "refuses_start" if what == "refuse" else "full"
            setattr(printer, name, True)
            loop.call_later(for_s, setattr, printer, name, False)
        elif what == "kill" and not self.world.killed.is_set():
            with suppress(Killed):
                self.world.kill()
        else:
            await self.asked(self._wish, what, printer)

    def _resume(self, printer: FakePrinter) -> None:
        if printer.state == "paused":
            printer.resume()

    async def _wish(self, what: str, printer: FakePrinter) -> None:
        farm = self.world.farm
        if what == "user cancels":
            await farm.cancel(printer.id, "boss")
        elif what == "stop":
            await farm.stop([printer.id], "boss")
        elif what == "queue":
            await farm.pause_queue(True, "boss")
            asyncio.get_running_loop().create_task(self._continue())
        elif what == "user cancels job" and self.world.store.jobs:
            await farm.cancel_job(self.chance.choice(list(self.world.store.jobs)), "boss")

    async def _continue(self) -> None:
        await asyncio.sleep(100.0)
        while self.world.store.queue_paused:
            await self.asked(lambda: self.world.farm.pause_queue(False, "boss"))
            await asyncio.sleep(10.0)

    async def _look_after(self, printer: FakePrinter) -> None:
        """What a careful user does at a printer."""
        farm = self.world.farm
        printer.restart()
        view = self.world.shown(printer)
        if view.attention:
            started = None
            if view.start_unknown:
                started = any(start.run == view.run for start in printer.starts)
            await farm.attend(printer.id, started, "anna")
        if printer.job is None and not view.bed_clear:
            printer.on_bed = False
            await farm.clear(printer.id, "anna")

    async def asked(self, wish: Callable, *values: object) -> None:
        """A user asks the hub; it may be dead, or refuse."""
        if self.world.killed.is_set():
            return
        with suppress(PassoError, Killed, StopIteration):
            await wish(*values)

    def _begins(self, printer: FakePrinter) -> None:
        """A print begins: its start is on the disk, and the power of its group suffices."""
        if printer.job is not None and printer.job.run:
            sql = "select state from runs where id = ?"
            # Past the hub, which may be dead.
            found = sqlite3.Connection.execute(self.world.disk, sql, (printer.job.run,)).fetchone()
            if found is None or found[0] in ("assigned", "uploading", "uploaded"):
                self.violations.append(f"{printer.name}: started while it is stored as {found}")
        self._check_power(printer)

    def _check_power(self, printer: FakePrinter) -> None:
        group, _ = self.groups.get(printer.id, ("", 0.0))
        if not group:
            return
        # Prints that users begin at the printers are not the hub's.
        sum_w = sum(
            heating_w
            for id, (of, heating_w) in self.groups.items()
            if of == group and (one := self.world.printers[id]).heating and one.job.run
        )
        if sum_w > self.limits_w[group]:
            self.violations.append(f"{printer.name}: {sum_w} W in {group}")

    def check(self) -> None:
        """What must hold at the end."""
        world = self.world
        starts = Counter(run for _, run, _ in world.starts())
        assert [run for run, n in starts.items() if n > 1] == []
        for printer in world.printers.values():
            assert [start for start in printer.starts if start.occupied] == []
        assert self.violations == []
        runs = {row.id: row for row in world.store.select(RUNS, "", ())}
        assert set(starts) <= set(runs)
        for printer in world.printers.values():
            for id, (_, state, _) in printer.runs.items():
                row = runs[id]
                self.seen[f"{state} {row.state.value}"] += 1
                if row.state is RunState.CANCELLED:
                    assert row.cancelled_by or row.reason or state == "cancelled", row
                else:
                    assert (row.state.value, row.printer) == (state, printer.id), row
        for row in runs.values():
            assert row.state.over, row
            if row.state is RunState.DONE:
                assert starts[row.id] == 1, row
            if row.state is RunState.FAILED:
                assert row.reason, row
        for job in world.store.select(JOBS, "", ()):
            of = [row for row in runs.values() if row.job == job.id]
            assert job.over_s is not None, job
            kept = sum(not row.gives_back for row in of)
            assert kept == job.given <= job.quantity, job
            assert job.cancelled or kept == job.quantity, job
