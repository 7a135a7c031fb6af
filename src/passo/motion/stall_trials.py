"""Finds the threshold of the stall detection of an axis, with trial moves to the end of its
travel."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, NamedTuple

from passo.errors import CommandError

if TYPE_CHECKING:
    from passo.motion.homing import Homer

_FREE = 20.0  # mm or degrees that an axis moves freely in a trial
_PRESS = 6.0  # it may press on its stop for so long
_NEAR = 2.0  # trials reach the same place within this
_SHIFT = 0.2  # of the range: less sensitive in the search for the stop
_LEAST_RANGE = 5
_TRIES = 2  # in which no stall may be detected
_SHARE = 1 / 3  # of the range, from the value that just stops


class Thresholds(NamedTuple):
    """The thresholds of a chip by their sensitivity, from 0 on. If `rising`, a high threshold is
    sensitive."""

    least: int
    most: int
    rising: bool

    @property
    def top(self) -> int:
        """The greatest sensitivity."""
        return self.most - self.least

    def of(self, sensitivity: int) -> int:
        """The threshold with this sensitivity."""
        return self.least + sensitivity if self.rising else self.most - sensitivity


class StallTrials:
    """The trials of one axis, which is in the middle of its travel at first. `use` sets a
    threshold, `say` reports progress. Methods raise CommandError and MachineError."""

    def __init__(
        self,
        homer: Homer,
        home: str,
        thresholds: Thresholds,
        use: Callable[[int], None],
        say: Callable[[str], None],
    ) -> None:
        self._homer, self._home = homer, home
        self._thresholds, self._use, self._say = thresholds, use, say
        self._away = _FREE  # from the stop, once that is known

    async def find(self) -> int:
        """Returns the threshold: at a third of the range between the one that just stops and the
        one that stops without a load. The axis is then `_FREE` away from its stop."""
        thresholds = self._thresholds
        highest = await self._last(0, thresholds.top + 1, self._moves_freely)
        self._say(f"{self._name}: threshold {thresholds.of(highest)} still moves freely")
        self._use(thresholds.of(highest - round(_SHIFT * highest)))
        far = self._homer.travel(self._home)
        if await self._homer.stall_within(self._home, far, _FREE) is None:
            raise self._unstable(highest, highest)
        again = await self._homer.stall_within(self._home, _FREE + _PRESS, _FREE)
        if again is None or abs(again - _FREE) > _NEAR:
            raise self._unstable(highest, highest)
        lowest = 1 + await self._last(-1, highest, self._presses)
        self._say(f"{self._name}: threshold {thresholds.of(lowest)} just stops at the end")
        if highest - lowest < _LEAST_RANGE:
            raise self._unstable(lowest, highest)
        return thresholds.of(lowest + round((highest - lowest) * _SHARE))

    async def spread(self, repeats: int) -> float:
        """Homes so many times; returns by how much the places differ where it stopped."""
        places: list[float] = []
        for _ in range(repeats + 1):
            far = self._away + _PRESS
            moved = await self._homer.stall_within(self._home, far, _FREE)
            if moved is None or moved < self._away - _NEAR - _PRESS:
                raise self._unstable(0, 0)
            places.append(moved - self._away)
            self._away = _FREE
        await self._homer.home(self._home.upper())
        return max(places[1:]) - min(places[1:])

    @property
    def _name(self) -> str:
        return self._home.upper()

    async def _last(self, low: int, high: int, holds: Callable[[], Awaitable[bool]]) -> int:
        """The greatest sensitivity for which it holds, from `low`, where it does, to below
        `high`."""
        while high - low > 1:
            middle = (low + high) // 2
            self._use(self._thresholds.of(middle))
            if await holds():
                low = middle
            else:
                high = middle
        return low

    async def _moves_freely(self) -> bool:
        for _ in range(_TRIES):
            if await self._homer.stall_within(self._home, _FREE, None) is not None:
                return False
        return True

    async def _presses(self) -> bool:
        """Whether the motor presses on the stop, and no stall is detected."""
        far = self._away + _PRESS
        moved = await self._homer.stall_within(self._home, far, None)
        if moved is None:
            self._away = far
        return moved is None

    def _unstable(self, lowest: int, highest: int) -> CommandError:
        low, high = self._thresholds.of(lowest), self._thresholds.of(highest)
        return CommandError.of(
            "machine.stall-unstable",
            axis=self._name,
            value=f"{low} to {high}",
            limit=f"{_LEAST_RANGE}",
        )
