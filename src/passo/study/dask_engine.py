"""Computes shards on a cluster of dask.distributed.

| event | what the engine does |
|---|---|
| a worker has another version, or another self-test | gives it no shard, and reports it |
| a worker lacks a file | sends the file, by its hash |
| a worker dies | dask computes the shard on other workers |
| a shard ends several workers | computes each of its cases again, alone |
| a case alone ends several workers | its result is `crash` |
| a case takes too long | its result is `timeout`; the worker restarts |
"""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from passo.errors import MachineError, Problem
from passo.study.dask_work import Identity, Outcome, identity, run_shard
from passo.study.engine import Done
from passo.study.work import Shard, failure, split

if TYPE_CHECKING:
    from passo.study.case import Content

_log = logging.getLogger(__name__)
_CONNECT_S = 30
_LOOK_S = 0.5  # interval in which `completed` returns
_AHEAD = 2  # shards for each thread, so that none waits for the network


@dataclass(slots=True)
class _Sent:
    shard: Shard
    alone: bool
    contents: Mapping[str, Any] = field(default_factory=dict[str, Any])  # futures of bytes
    workers: frozenset[str] = frozenset()  # the addresses of those that may compute it


class DaskEngine:
    """Computes on the workers of a client of dask.distributed. A case has `timeout_s`. Workers that
    come later are used, too."""

    shard_s = 15.0

    def __init__(
        self,
        client: Any,
        timeout_s: float,
        own: Identity | None = None,
        read: Callable[[Content], bytes] = lambda file: Path(file.path).read_bytes(),
    ) -> None:
        """`own` is the identity that workers must have, by default that of this process; `read`
        reads a file that a worker lacks. Raises MachineError if no worker can be used."""
        self._client, self._timeout_s, self._read = client, timeout_s, read
        self._own = own or identity()
        self._threads: dict[str, int] = {}  # of the workers that are used, by their address
        self._refused: dict[str, str] = {}
        self._sent: dict[Any, _Sent] = {}  # by future
        self._waiting: deque[_Sent] = deque()
        self._scattered: dict[str, Any] = {}
        self._check_workers()
        if not self._threads:
            reasons = "; ".join(f"{at}: {why}" for at, why in self._refused.items())
            raise self._failed(reasons or "it has no workers")

    @classmethod
    def at(cls, address: str, timeout_s: float) -> Self:
        """The cluster whose scheduler has this address. Raises MachineError."""
        if find_spec("distributed") is None:
            raise MachineError.of("study.package", value="dask.distributed")
        distributed: Any = import_module("distributed")
        try:
            client = distributed.Client(address, timeout=_CONNECT_S, set_as_default=False)
        except (OSError, ValueError) as error:
            reason = str(error) or "it does not answer"
            raise MachineError.of("study.cluster", value=address, limit=reason) from None
        try:
            return cls(client, timeout_s)
        except BaseException:
            client.close()
            raise

    @property
    def workers(self) -> int:
        """The threads of the workers that are used."""
        return sum(self._threads.values())

    @property
    def free(self) -> bool:
        """Whether a worker would soon have no shard."""
        return not self._waiting and len(self._sent) < _AHEAD * self.workers

    @property
    def busy(self) -> bool:
        """Whether there are shards without results."""
        return bool(self._sent or self._waiting)

    def submit(self, shard: Shard) -> None:
        """Takes a shard."""
        self._submit(_Sent(shard, len(shard.works) == 1))

    def completed(self) -> list[Done]:
        """Waits until shards are done or for a moment, and returns those that are done. Raises
        MachineError if the cluster has ended."""
        distributed: Any = import_module("distributed")
        self._check_workers()
        self._take_back()
        while self._waiting and len(self._sent) < _AHEAD * self.workers:
            self._submit(self._waiting.popleft())
        if not self._sent:  # all workers have gone
            with suppress(TimeoutError):
                self._client.wait_for_workers(len(self._refused) + 1, timeout=_LOOK_S)
            return []
        try:
            with self._client.as_current():
                ended: Any = distributed.wait(
                    list(self._sent), timeout=_LOOK_S, return_when="FIRST_COMPLETED"
                )
        except TimeoutError:
            return []
        except OSError as error:
            raise self._failed(str(error)) from None
        taken = (self._take(future, self._sent.pop(future)) for future in ended.done)
        return [done for some in taken for done in some]

    def close(self) -> None:
        """Cancels what the workers compute, and leaves the cluster."""
        self._client.cancel(list(self._sent))
        self._sent.clear()
        self._waiting.clear()
        self._client.close()

    def _submit(self, sent: _Sent) -> None:
        future = self._client.submit(
            run_shard,
            sent.shard,
            dict(sent.contents),
            self._timeout_s,
            workers=list(self._threads),
            pure=False,
        )
        sent.workers = frozenset(self._threads)
        self._sent[future] = sent

    def _take(self, future: Any, sent: _Sent) -> list[Done]:
        """The results of a shard; the rest of it is sent again."""
        distributed: Any = import_module("distributed")
        if future.status == "cancelled":
            raise self._failed("its scheduler has ended")
        error = future.exception()
        if isinstance(error, distributed.KilledWorker):
            return self._killed(sent)
        if error is not None:
            raise error
        outcome: Outcome = future.result()
        if outcome.lacking:
            self._send_files(sent, outcome.lacking)
            return []
        return self._done(future, sent.shard, outcome)

    def _done(self, future: Any, shard: Shard, outcome: Outcome) -> list[Done]:
        results, works = list(outcome.results), shard.works
        if outcome.late:
            problem = Problem("study.timeout", values={"value": f"{self._timeout_s:g}"})
            results.append(failure("timeout", problem))
            self._restart_worker_of(future)
            if rest := works[len(results) :]:
                self._waiting.append(_Sent(shard._replace(works=rest), alone=False))
        return [Done(shard._replace(works=works[: len(results)]), results)]

    def _killed(self, sent: _Sent) -> list[Done]:
        if not sent.alone:
            self._waiting.extend(_Sent(s, True, sent.contents) for s in split(sent.shard))
            return []
        problem = Problem("study.crash", values={"value": "the end of its worker"})
        return [Done(sent.shard, [failure("crash", problem)])]

    def _send_files(self, sent: _Sent, hashes: tuple[str, ...]) -> None:
        files = {work.file.sha256: work.file for work in sent.shard.works}
        for sha256 in hashes:
            if sha256 not in self._scattered:
                content = self._read(files[sha256])
                self._scattered[sha256] = self._client.scatter(content, hash=False)
        contents = {sha256: self._scattered[sha256] for sha256 in hashes}
        self._waiting.append(_Sent(sent.shard, sent.alone, contents))

    def _restart_worker_of(self, future: Any) -> None:
        """Ends a worker that still computes a late case. Its nanny starts a new one."""
        for addresses in self._client.who_has([future]).values():
            self._client.restart_workers(list(addresses), raise_for_error=False)

    def _check_workers(self) -> None:
        """Uses new workers with the same identity."""
        present = self._client.scheduler_info(n_workers=-1)["workers"]
        self._threads = {at: n for at, n in self._threads.items() if at in present}
        new = [at for at in present if at not in self._threads and at not in self._refused]
        if not new:
            return
        found = self._client.run(identity, workers=new, on_error="return")
        for at, reason in refusals(found, self._own).items():
            _log.warning("worker %s is not used: %s", at, reason)
            self._refused[at] = reason
        self._threads |= {at: present[at]["nthreads"] for at in found if at not in self._refused}

    def _take_back(self) -> None:
        """Sends shards again whose workers have all gone: a worker that starts again has another
        address."""
        for future, sent in list(self._sent.items()):
            if sent.workers.isdisjoint(self._threads):
                self._client.cancel([future])
                del self._sent[future]
                self._waiting.append(sent)

    def _failed(self, reason: str) -> MachineError:
        return MachineError.of("study.cluster", value=self._client.scheduler.address, limit=reason)


def refusals(found: Mapping[str, object], own: Identity) -> dict[str, str]:
    """Why workers with other identities are not used, by their address."""
    reasons: dict[str, str] = {}
    for at, theirs in found.items():
        if not isinstance(theirs, Identity):
            reasons[at] = f"it cannot run Passo ({theirs!r})"
        elif theirs.version != own.version:
            reasons[at] = f"it has Passo {theirs.version}, not {own.version}"
        elif theirs != own:
            reasons[at] = f"its self-test gives {theirs.self_test}, not {own.self_test}"
    return reasons
