"""Power groups: how much their printers take, and which starts that allows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from passo.web.summary import Summary

# A heater counts as warm this close to its target: then it takes a part of its power only.
NEAR_C = 5


@dataclass(frozen=True, slots=True)
class Load:
    """A printer of a power group. `heating`: it takes its full power now, or may take it."""

    group: str
    heating_w: float
    heating: bool


@dataclass(frozen=True, slots=True)
class Start:
    """A run that is ready to start, and the load of its printer."""

    run: str
    group: str
    heating_w: float


def heating(seen: Summary | None, starting: bool) -> bool:
    """Whether a printer takes its full power. `seen` is None while nothing is known of it: it
    counts as heating then. `starting`: a start is sent, and the printer does not show it yet.

    A print heats until its heaters are warm and filament moves: between two waits of its program,
    all heaters may be warm for a moment.
    """
    if seen is None or starting:
        return True
    if seen.state == "halted":
        return False
    cold = any(
        heater.target_c and (heater.celsius is None or heater.celsius < heater.target_c - NEAR_C)
        for heater in seen.heaters
    )
    begins = seen.state == "printing" and seen.job is not None and not seen.job.filament_mm
    return cold or begins


def used_w(loads: Sequence[Load]) -> dict[str, float]:
    """The power of the heating printers of each group."""
    used: dict[str, float] = {}
    for load in loads:
        if load.group and load.heating:
            used[load.group] = used.get(load.group, 0.0) + load.heating_w
    return used


def admitted(
    starts: Sequence[Start], loads: Sequence[Load], limits_w: Mapping[str, float]
) -> list[str]:
    """The runs that may start now, in the order of `starts`: with each of them the heating printers
    of its group stay within its limit. The first one of a group that must wait makes the later ones
    of this group wait, so that a large printer gets its turn."""
    used, full, runs = used_w(loads), set[str](), list[str]()
    for start in starts:
        limit_w = limits_w.get(start.group)
        if limit_w is not None:
            sum_w = used.get(start.group, 0.0) + start.heating_w
            if start.group in full or sum_w > limit_w:
                full.add(start.group)
                continue
            used[start.group] = sum_w
        runs.append(start.run)
    return runs
