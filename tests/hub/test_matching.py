"""Jobs go to printers by their definition, for thousands of farms at random."""

from __future__ import annotations

from random import Random

import pytest
from tests.oracles.matching import assignments, possible

from passo.hub.matching import Fit, Order, Place, match, reason
from passo.hub.views import Loaded

FITS = Fit(True)
PLA = Loaded(material="PLA")


def anything(chance: Random, rare: float) -> Loaded:
    def one(*values):
        return chance.choice(values) if chance.random() < rare else type(values[0])()

    return Loaded(
        one("PLA", "pla", "PETG"),
        one("red", "blue"),
        chance.choice((0.4, 0.6)) if chance.random() < rare else None,
        one("smooth", "rough"),
    )


def farm(seed: int):
    """Jobs, printers, and which file fits which printer."""
    chance = Random(seed)
    places = [
        Place(
            f"p{i}",
            chance.choice("abc"),
            frozenset(chance.sample(("big", "hall 2"), chance.randint(0, 2))),
            anything(chance, 0.7),
            chance.choice(("", "", "", "printing", "bed not cleared")),
        )
        for i in range(chance.randint(0, 7))
    ]
    ids = [place.id for place in places]
    orders = []
    for i in range(chance.randint(0, 7)):
        by_each = chance.random() < 0.2
        orders.append(
            Order(
                f"j{i}",
                i,
                chance.choice("fg"),
                chance.randint(1, 3),
                chance.randint(0, 1),
                chance.choice((None, 5.0, 9.0)),
                anything(chance, 0.2),
                anything(chance, 0.2),
                frozenset(("big",) if chance.random() < 0.2 else ()),
                by_each,
                frozenset(chance.sample(ids, min(2, len(ids)))) if by_each else frozenset(),
                frozenset(chance.sample(ids, min(chance.randint(0, 2), len(ids)))),
            )
        )
    kinds = (Fit(True, "", 60.0), Fit(True, "", 50.0), FITS, FITS, Fit(False, "too large"), None)
    fits = {(file, id): chance.choice(kinds) for file in "fg" for id in ids}
    chance.shuffle(orders)
    return orders, places, fits, chance


@pytest.mark.parametrize("some", range(4))
def test_matching_agrees_with_its_definition(some):
    assigned = 0
    for seed in range(some * 1000, some * 1000 + 1000):
        orders, places, fits, chance = farm(seed)
        found = match(orders, places, lambda file, id, fits=fits: fits[file, id])
        assert found == assignments(orders, places, fits), seed
        chance.shuffle(places)
        assert match(orders[::-1], places, lambda file, id, fits=fits: fits[file, id]) == found
        assigned += len(found)
    assert assigned > 800


def test_job_that_waits_says_why():
    waiting = begun = 0
    for seed in range(500):
        orders, places, fits, _ = farm(seed)
        for order in orders:
            why = reason(order, places, lambda file, id, fits=fits: fits[file, id])
            can = any(not place.taken and possible(order, place, fits) for place in places)
            assert (why == "") == can, (seed, order)
            waiting, begun = waiting + (not can), begun + can
    assert waiting > 300 and begun > 300


def place(id: str, loaded: Loaded = PLA, taken: str = "") -> Place:
    return Place(id, id, frozenset(), loaded, taken)


def test_reasons_name_the_nearest_obstacle():
    petg, busy = place("a", Loaded(material="PETG")), place("b", taken="printing")
    order = Order("j", 1, "f", 1, needs=PLA)
    assert reason(order, [], lambda *_: FITS) == "The farm has no printers"
    assert reason(order, [petg, busy], lambda *_: FITS) == "No printer is free: printing (1)"
    why = reason(order, [petg, petg], lambda *_: FITS)
    assert why == "No printer suits: material PLA is not loaded (2)"
    why = reason(order, [busy], lambda *_: Fit(False, "Y 235 mm is outside 0 to 220 mm"))
    assert why == "No printer suits: Y 235 mm is outside 0 to 220 mm (1)"
    assert reason(order, [busy], lambda *_: None) == (
        "No printer suits: its check is not finished (1)"
    )


def test_job_for_any_material_leaves_the_wanted_one_free():
    places = [place("a"), place("b", Loaded(material="PETG"))]
    orders = [Order("any", 1, "f", 1), Order("pla", 2, "f", 1, needs=PLA)]
    assert match(orders, places, lambda *_: FITS) == [("any", "b"), ("pla", "a")]
