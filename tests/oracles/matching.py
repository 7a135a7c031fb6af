"""Which job goes to which printer, by its definition: the best one of all pairs that are possible,
again and again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf

from passo.hub.matching import Fit, Order, Place
from passo.hub.views import Loaded

ANY = Loaded()


def has(loaded: Loaded, needs: Loaded) -> bool:
    """Whether a printer has all that is needed."""
    words = [
        (needs.material, loaded.material),
        (needs.colour, loaded.colour),
        (needs.plate, loaded.plate),
    ]
    return all(not need or need.lower() == there.lower() for need, there in words) and (
        needs.nozzle_mm is None or needs.nozzle_mm == loaded.nozzle_mm
    )


def possible(order: Order, place: Place, fits: Mapping[tuple[str, str], Fit | None]) -> bool:
    """Whether a free printer may print a job."""
    fit = fits[order.file, place.id]
    slicer, there = order.says, place.loaded
    contradicts = (
        not order.needs.material
        and slicer.material
        and there.material
        and slicer.material.lower() != there.material.lower()
    ) or (
        order.needs.nozzle_mm is None
        and None not in (slicer.nozzle_mm, there.nozzle_mm)
        and slicer.nozzle_mm != there.nozzle_mm
    )
    return (
        has(there, order.needs)
        and not contradicts
        and order.tags <= place.tags
        and (not order.by_each or place.id in order.each)
        and fit is not None
        and fit.fits
    )


def assignments(
    orders: Sequence[Order], places: Sequence[Place], fits: Mapping[tuple[str, str], Fit | None]
) -> list[tuple[str, str]]:
    """The pairs of jobs and printers, in the order of the jobs."""
    left = {order.id: order.copies for order in orders}
    free = {place.id: place for place in places if not place.taken}
    found: list[tuple[str, str]] = []

    def key(order: Order, place: Place) -> tuple[object, ...]:
        asked = [o for o in orders if o.id != order.id and o.needs != ANY]
        fit = fits[order.file, place.id]
        return (
            -order.priority,
            inf if order.due_s is None else order.due_s,
            order.number,
            place.id in order.failed_on,
            sum(has(place.loaded, other.needs) for other in asked),
            inf if fit is None or fit.print_s is None else fit.print_s,
            place.name,
            place.id,
        )

    while True:
        pairs = [
            (order, place)
            for order in orders
            for place in free.values()
            if left[order.id] and possible(order, place, fits)
        ]
        if not pairs:
            return found
        order, place = min(pairs, key=lambda pair: key(*pair))
        left[order.id] -= 1
        del free[place.id]
        found.append((order.id, place.id))
