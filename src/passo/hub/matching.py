"""Which job starts on which printer: a pure function of the jobs and the printers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf

from passo.hub.views import Loaded

_NOZZLE_MM = 0.001  # nozzles that differ by less are equal
_ANY = Loaded()


@dataclass(frozen=True, slots=True)
class Fit:
    """Whether a file fits a machine; `why` not. `print_s` is its estimate on this machine."""

    fits: bool
    why: str = ""
    print_s: float | None = None


@dataclass(frozen=True, slots=True)
class Place:
    """A printer. `taken` says why no run can begin on it now, or is empty."""

    id: str
    name: str
    tags: frozenset[str]
    loaded: Loaded
    taken: str = ""


@dataclass(frozen=True, slots=True)
class Order:
    """An open job that waits for `copies` more prints. `number` is its place in the order of
    arrival. `says` is what the slicer has written about the file. `each` are the printers that must
    still print it, in place of a free choice, if `by_each`. `failed_on` are printers on which a run
    of it has failed."""

    id: str
    number: int
    file: str
    copies: int
    priority: int = 0
    due_s: float | None = None
    needs: Loaded = _ANY
    says: Loaded = _ANY
    tags: frozenset[str] = frozenset()
    by_each: bool = False
    each: frozenset[str] = frozenset()
    failed_on: frozenset[str] = frozenset()

    @property
    def kind(self) -> tuple[object, ...]:
        """Equal for jobs that suit the same printers."""
        return self.file, self.needs, self.says, self.tags, self.by_each, self.each


Fits = Callable[[str, str], Fit | None]  # of a file (SHA-256) and a printer; None: not known yet


def match(orders: Sequence[Order], places: Sequence[Place], fits: Fits) -> list[tuple[str, str]]:
    """Jobs and the printers on which a run of them begins now.

    Jobs choose by priority, then by the time when they are due, then by arrival. A job takes, among
    the free printers that suit it: one on which it has not failed; one whose material, colour,
    nozzle and plate the fewest other waiting jobs ask for, so that fewer changes are needed; the
    one that is ready first by its estimate; the first by name and id.
    """
    free = sorted((p for p in places if not p.taken), key=lambda place: (place.name, place.id))
    found: list[tuple[str, str]] = []
    hopeless: set[object] = set()  # what suits no free printer, for many equal jobs
    queue = sorted(orders, key=_turn)
    if not free:
        return found
    asked = Counter(order.needs for order in queue if order.needs != _ANY)
    for order in queue:
        if not free:
            break
        if order.kind in hopeless:
            continue
        left = order.each
        for _ in range(order.copies):
            suited = [p for p in free if _obstacle(order, p, fits, left) is None]
            if not suited:
                hopeless.add(order.kind)
                break
            others = asked - Counter({order.needs: 1})
            best = min(suited, key=lambda place: _rank(order, place, others, fits))
            free.remove(best)
            left -= {best.id}
            found.append((order.id, best.id))
    return found


def reason(order: Order, places: Sequence[Place], fits: Fits) -> str:
    """Why no run of a job begins now: a sentence without its full stop; empty if one can begin."""
    if not places:
        return "The farm has no printers"
    unfit, taken = Counter[str](), Counter[str]()
    for place in places:
        obstacle = _obstacle(order, place, fits, order.each)
        if obstacle is not None:
            unfit[obstacle] += 1
        elif place.taken:
            taken[place.taken] += 1
        else:
            return ""
    head, counts = ("No printer is free", taken) if taken else ("No printer suits", unfit)
    return f"{head}: {', '.join(f'{text} ({n})' for text, n in sorted(counts.items()))}"


def _turn(order: Order) -> tuple[int, float, int]:
    return -order.priority, inf if order.due_s is None else order.due_s, order.number


def _rank(
    order: Order, place: Place, others: Counter[Loaded], fits: Fits
) -> tuple[bool, int, float, str, str]:
    fit = fits(order.file, place.id)
    print_s = inf if fit is None or fit.print_s is None else fit.print_s
    wanted = sum(n for needs, n in others.items() if lacks(needs, place.loaded) is None)
    return place.id in order.failed_on, wanted, print_s, place.name, place.id


def _obstacle(order: Order, place: Place, fits: Fits, each: frozenset[str]) -> str | None:
    """Why a printer does not suit a job, even if it is free."""
    if order.by_each and place.id not in each:
        return "the job is for other printers"
    missing = order.tags - place.tags
    if missing:
        return f"tag {min(missing)} is missing"
    lack = lacks(order.needs, place.loaded) or _differs(order, place.loaded)
    if lack is not None:
        return lack
    fit = fits(order.file, place.id)
    if fit is None:
        return "its check is not finished"
    return None if fit.fits else fit.why or "the file does not fit the machine"


def lacks(needs: Loaded, loaded: Loaded) -> str | None:
    """What a printer lacks of what a job needs. What a printer does not state, it lacks."""
    for kind, wanted, there in (
        ("material", needs.material, loaded.material),
        ("colour", needs.colour, loaded.colour),
        ("plate", needs.plate, loaded.plate),
    ):
        if wanted and wanted.casefold() != there.casefold():
            return f"{kind} {wanted} is not loaded"
    nozzle_mm = needs.nozzle_mm
    if nozzle_mm is None or _equal(nozzle_mm, loaded.nozzle_mm):
        return None
    return f"the nozzle is not {nozzle_mm:g} mm"


def _differs(order: Order, loaded: Loaded) -> str | None:
    """What a printer states otherwise than the slicer, where the job itself asks for nothing."""
    material = order.says.material
    if (
        material
        and loaded.material
        and not order.needs.material
        and material.casefold() != loaded.material.casefold()
    ):
        return f"the file is for {material}"
    nozzle_mm = order.says.nozzle_mm
    if nozzle_mm is None or loaded.nozzle_mm is None or order.needs.nozzle_mm is not None:
        return None
    return None if _equal(nozzle_mm, loaded.nozzle_mm) else f"the file is for {nozzle_mm:g} mm"


def _equal(wanted_mm: float, there_mm: float | None) -> bool:
    return there_mm is not None and abs(wanted_mm - there_mm) <= _NOZZLE_MM
