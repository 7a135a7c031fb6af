"""Facts about the files of a card: the slicer's comments at once, the plan as soon as it is
computed."""

from __future__ import annotations

import asyncio
import hashlib
import logging
from dataclasses import asdict
from io import BufferedReader, TextIOWrapper
from typing import TYPE_CHECKING, Literal

import msgspec
from msgspec import Struct

from passo.card.unheld import Unheld
from passo.errors import CardError, PassoError, in_words
from passo.version import __version__
from passo.web.answers import Fault, fault
from passo.web.files.comments import Comments, read_comments
from passo.web.files.incoming import in_worker_thread
from passo.web.files.metadata_cache import MetadataCache
from passo.web.files.toolpaths import Toolpaths

if TYPE_CHECKING:
    from pathlib import Path

    from passo.card import Card, Entry
    from passo.job.batch.estimate import Estimate
    from passo.web.bridge import Bridge

_log = logging.getLogger(__name__)
_HEAD = 1 << 21  # characters that are searched for comments


class Plan(Struct):
    """A file as this printer would print it. `total_s` is the sum of `moving_s`, `dwell_s` and
    `heating_s`; `limits_s` has, for each limit of the machine, the time for which it limits the
    speed."""

    total_s: float
    moving_s: float
    dwell_s: float
    heating_s: float
    layers: int
    moves: int
    filament_mm: dict[str, float]
    limits_s: dict[str, float]
    warnings: list[str]


class Picture(Struct):
    """A thumbnail: the number by which it can be requested, and its size in pixels."""

    number: int
    width: int
    height: int
    type: str


Allowance = Literal["unknown", "levelling", "clamp", "ignore_tools"]


class Metadata(Struct):
    """Facts about a file. `state` is `pending` until the plan is computed. It is `refused` if a
    print of the file as it is fails; then `problems` has the reasons, for example moves out of
    range. `allow` is what `job.start` must allow so that the file can be printed in spite of them:
    to skip `unknown` commands that may move the machine, to skip the `levelling` of the bed, to
    `clamp` moves to the limits of the machine, to `ignore_tools` that are missing. `plan` is the
    plan of that print. An empty `allow` of a refused file: it cannot be printed."""

    path: str
    state: Literal["pending", "known", "refused"]
    slicer: str
    objects: list[str]
    thumbnails: list[Picture]
    plan: Plan | None = None
    problems: list[Fault] = []
    allow: list[Allowance] = []


class MetadataReader:
    """Reads the facts about the files of one printer. Use it in the web's event loop. Plans are
    computed one after the other, in a process of low priority: that of the newest request first,
    because a user waits for it."""

    def __init__(self, bridge: Bridge, folder: Path | None) -> None:
        self._bridge = bridge
        made_for = f"{__version__} {bridge.skips} {bridge.machine.model_dump_json()}"
        digest = hashlib.blake2b(made_for.encode(), digest_size=16).hexdigest()
        self._cache = MetadataCache(folder, digest)
        self._toolpaths = Toolpaths(folder, digest)
        # The newest request is the last; the event is set when the plan is known.
        self._wanted: dict[str, asyncio.Event] = {}
        self._task: asyncio.Task[None] | None = None

    async def get(self, path: str) -> Metadata:
        """The facts that are known about the file at a confined path; starts to compute the rest.
        Raises CardError."""
        card = await self._bridge.card()
        entry = await in_worker_thread(lambda: card.find(path))
        if entry.is_directory:
            raise CardError.of("card.directory", path)
        if (found := self._cache.get(path, entry)) is not None:
            return msgspec.json.decode(found, type=Metadata)
        self.want(path)
        return await _begun(card, path)

    async def toolpath(self, path: str) -> Path | None:
        """The planned path of a file, see job/batch/toolpath.py; None if the file cannot be printed
        as it is. Waits until it is planned. Raises CardError."""
        card = await self._bridge.card()
        entry = await in_worker_thread(lambda: card.find(path))
        if (found := self._toolpaths.find(path, entry)) is not None:
            return found
        await self.want(path).wait()
        entry = await in_worker_thread(lambda: card.find(path))
        return self._toolpaths.find(path, entry)

    def want(self, path: str) -> asyncio.Event:
        """Requests the file's plan, before those of earlier requests. The returned event is set
        when it is known."""
        known = self._wanted.pop(path, None) or asyncio.Event()
        self._wanted[path] = known
        if self._task is None or self._task.done():
            self._task = asyncio.get_running_loop().create_task(self._work())
        return known

    async def _work(self) -> None:
        while self._wanted:
            path = next(reversed(self._wanted))
            try:
                await self._learn(path)
            except CardError:
                pass  # the file was replaced or removed in the meantime
            except Exception:
                _log.exception("%s: cannot be looked through", path)
            finally:
                self._wanted.pop(path).set()

    async def _learn(self, path: str) -> None:
        card = await self._bridge.card()
        entry = await in_worker_thread(lambda: card.find(path))
        if self._complete(path, entry):
            return
        found = await _begun(card, path)
        try:
            verdict = await self._bridge.verdict(
                path, lambda data: self._toolpaths.put(path, entry, data)
            )
            found.plan = verdict.estimate and _plan(verdict.estimate)
            found.problems = [fault(problem) for problem in verdict.problems]
            found.allow = msgspec.convert(verdict.allow, list[Allowance])
            found.state = "refused" if verdict.problems else "known"
        except CardError:
            raise
        except Exception as error:
            if not isinstance(error, PassoError):
                _log.exception("%s: cannot be planned", path)
            found.problems = [fault(problem) for problem in in_words(error).problems]
            found.state = "refused"
        if await in_worker_thread(lambda: card.find(path)) == entry:
            self._cache.put(path, entry, msgspec.json.encode(found))

    def _complete(self, path: str, entry: Entry) -> bool:
        """Whether all facts about this content of the file are known."""
        if (found := self._cache.get(path, entry)) is None:
            return False
        known = msgspec.json.decode(found, type=Metadata)
        return known.plan is None or self._toolpaths.find(path, entry) is not None


async def comments_of(card: Card, path: str) -> Comments:
    """The slicer's comments in a file. Raises CardError."""

    def read() -> Comments:
        raw = Unheld(card, path)
        with TextIOWrapper(BufferedReader(raw, 1 << 18), "utf-8", "replace") as text:
            return read_comments(text.read(min(raw.size, _HEAD)).splitlines())

    return await in_worker_thread(read)


async def _begun(card: Card, path: str) -> Metadata:
    comments = await comments_of(card, path)
    pictures = [
        Picture(number, picture.width, picture.height, picture.kind)
        for number, picture in enumerate(comments.thumbnails)
    ]
    return Metadata(path, "pending", comments.slicer, list(comments.objects), pictures)


def _plan(estimate: Estimate) -> Plan:
    return msgspec.convert(asdict(estimate), Plan)
