"""The interface of what computes shards, and the engine that computes them in this process."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple, Protocol

from passo.study.work import Compute, Result, Shard, compute


class Done(NamedTuple):
    """The results of a shard, in the order of its cases."""

    shard: Shard
    results: list[Result]


class Engine(Protocol):
    """Computes shards in any order. The results do not depend on the engine."""

    shard_s: float
    """The time that a shard should take, s."""

    @property
    def workers(self) -> int:
        """The number of shards that it computes at the same time."""
        ...

    @property
    def free(self) -> bool:
        """Whether another shard should be submitted now."""
        ...

    @property
    def busy(self) -> bool:
        """Whether there are shards without results."""
        ...

    def submit(self, shard: Shard) -> None:
        """Takes a shard."""
        ...

    def completed(self) -> list[Done]:
        """Waits until shards are done, and returns them; may return none, so that the caller shows
        its progress."""
        ...

    def close(self) -> None:
        """Ends the work at once; results that were not taken are lost."""
        ...


class Inline:
    """Computes in this process, one shard at a time. A crash of the core ends the process."""

    shard_s = 1.0
    workers = 1

    def __init__(self, compute: Compute = compute) -> None:
        self._compute = compute
        self._shards: deque[Shard] = deque()

    @property
    def free(self) -> bool:
        """Whether it has no shard."""
        return not self._shards

    @property
    def busy(self) -> bool:
        """Whether it has a shard."""
        return bool(self._shards)

    def submit(self, shard: Shard) -> None:
        """Takes a shard."""
        self._shards.append(shard)

    def completed(self) -> list[Done]:
        """Computes one shard."""
        shard = self._shards.popleft()
        return [Done(shard, self._compute(shard))]

    def close(self) -> None:
        """Drops the shards."""
        self._shards.clear()
