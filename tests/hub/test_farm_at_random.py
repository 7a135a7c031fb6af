"""Farms at random in virtual time: users, faults, lost answers, kills; the printers check."""

from __future__ import annotations

import asyncio
from functools import partial
from random import Random

import pytest
from tests.support.fake_printer import FakePrinter, Network
from tests.support.farm_life import Life
from tests.support.farm_world import World, play

from passo.hub.views import Loaded
from passo.hub.wishes import PrinterChange

HOUR_S = 3600.0
MATERIALS = ("PLA", "PETG")


async def farm_life(seed: int, printers: int, hours: float, jobs: int, fault_s: float):
    """A farm with faults for some hours, then without, until all jobs are over."""
    chance = Random(f"farm {seed}")
    fakes = [
        FakePrinter(
            f"p{i:03}",
            chance.uniform(60, 300),
            chance.uniform(900, 5400),
            knows_runs=i % 8 != 7,
            clears_itself=i % 8 == 2,
        )
        for i in range(printers)
    ]
    network = Network(0.02, 0.03, 0.02, late_s=chance.choice((5.0, 20.0, 45.0)))
    world = World(fakes, seed, network)
    life = Life(world, seed, {f"fuse{i}": 1000.0 for i in range(printers // 8 + 1)})
    await world.start()
    for i, printer in enumerate(fakes):
        loaded = Loaded(material=MATERIALS[i % len(MATERIALS)])
        change = PrinterChange(loaded=loaded, clears_itself=printer.clears_itself)
        await world.farm.change_printer(printer.id, change, "admin")
        if i % 4:
            await life.set_power(printer, f"fuse{i // 8}", chance.uniform(200, 400))
    await world.clear()
    loop, end_s = asyncio.get_running_loop(), hours * HOUR_S
    tasks = [
        loop.create_task(life.hub()),
        loop.create_task(life.faults(fault_s, end_s)),
        loop.create_task(add_jobs(world, life, chance, jobs, end_s)),
    ]
    await life.users(600.0, end_s + 60 * HOUR_S)
    for task in tasks:
        task.cancel()
    life.check()
    assert world.store.jobs == {}
    return world.log(), sum(state == "done" for state in world.states().values())


async def add_jobs(world: World, life: Life, chance: Random, jobs: int, until_s: float):
    """Users add jobs over most of the time."""
    for i in range(jobs):
        await asyncio.sleep(chance.uniform(0, 1.6) * until_s / jobs)
        needs, each = Loaded(material=chance.choice(("", *MATERIALS))), []
        if chance.random() < 0.2:
            needs, each = Loaded(), chance.sample(sorted(world.printers), 3)
        fields = {
            "quantity": chance.randint(1, 4),
            "priority": chance.randint(0, 2),
            "retries": chance.randint(0, 2),
        }
        name, user = f"part{i % 7}.gcode", chance.choice(("anna", "bert"))
        await life.asked(partial(world.job, name, user, needs=needs, each=each, **fields))


SMALL = {"printers": 8, "hours": 6.0, "jobs": 15, "fault_s": 200.0}


@pytest.mark.parametrize("some", range(10))
def test_small_farms_of_100_seeds(some):
    for seed in range(some * 10, some * 10 + 10):
        log, done = play(lambda seed=seed: farm_life(seed, **SMALL))
        assert done > 3 and len(log) > 100, seed


def test_same_seed_gives_the_same_log():
    first, _ = play(lambda: farm_life(7, **SMALL))
    second, _ = play(lambda: farm_life(7, **SMALL))
    assert first == second


def test_farm_of_200_printers():
    """Its connections, and the order of many equal printers, show only here."""
    _, done = play(lambda: farm_life(1, 200, 5.0, 200, 60.0))
    assert done > 300


@pytest.mark.long
def test_200_printers_for_a_day_with_100_seeds():
    """Some 200 000 runs: rare orders of lost answers, kills and faults. It takes half an hour."""
    for seed in range(100):
        _, done = play(lambda seed=seed: farm_life(seed, 200, 24.0, 800, 120.0))
        assert done > 1000, seed
