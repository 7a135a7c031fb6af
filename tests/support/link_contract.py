"""What a hub and a printer do together, step by step, and what the hub observes: the same with the
fake printer as with a real one."""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any, Protocol

from passo.hub.link import Link, Refused, Unreachable
from passo.web.summary import Summary

RUNS = [f"0000000{n}-0000-4000-8000-000000000000" for n in range(1, 5)]
USER = "anna"
_EACH_S = 60.0


class Bench(Protocol):
    """A printer of either kind. Through `lossy`, requests take effect but lose their answers."""

    link: Link
    lossy: Link

    def file(self) -> Path:
        """A file whose print lasts until it is cancelled."""
        ...

    def too_large(self) -> Path:
        """A file that the card has no place for; from now on, if the card is a fake."""
        ...

    async def restart(self) -> None:
        """Lets the printer's program end at once and begin again."""
        ...


EXPECTED = [
    ("upload", "same path"),
    ("upload of another hash", "Refused"),
    ("report of an unknown run", None),
    ("start without an answer", "Unreachable"),
    ("report", "printing"),
    ("start again", None),
    ("shown", ("printing", 0, True)),
    ("paused", ("paused", 0, True)),
    ("report", "paused"),
    ("resumed", ("printing", 0, True)),
    ("start of another run", "Refused"),
    ("report of the refused run", "failed"),
    ("still shown", ("printing", 0, True)),
    ("cancelled", ("idle", "cancelled", 0)),
    ("report", "cancelled"),
    ("start of an ended run", None),
    ("nothing started", ("idle", "cancelled", 0)),
    ("stopped", ("halted", "failed", 2)),
    ("report", "failed"),
    ("after the restart", ("idle", "failed", 2)),
    ("reports", ["cancelled", "failed", "failed", None]),
    ("start of an ended run", None),
    ("upload to a full card", "Refused"),
]


async def observations(bench: Bench) -> list[tuple[str, Any]]:
    """What the hub observes."""
    seen: list[tuple[str, Any]] = []
    link, news = bench.link, _News(bench)
    content = bench.file()
    sha256 = hashlib.sha256(content.read_bytes()).hexdigest()

    async def note(what: str, done: Awaitable[Any]) -> None:
        seen.append((what, await _outcome(done)))

    first = await link.upload(content, "part.gcode", sha256)
    again = await link.upload(content, "part.gcode", sha256)
    seen.append(("upload", "same path" if first == again else (first, again)))
    await note("upload of another hash", link.upload(content, "part.gcode", "0" * 64))
    await note("report of an unknown run", _state(link, RUNS[0]))
    await note("start without an answer", bench.lossy.start(RUNS[0], first, USER))
    await note("report", _state(link, RUNS[0]))
    await note("start again", link.start(RUNS[0], first, USER))
    await note("shown", news.until(_prints("printing")))
    await link.pause(USER)
    await note("paused", news.until(_prints("paused")))
    await note("report", _state(link, RUNS[0]))
    await link.resume(USER)
    await note("resumed", news.until(_prints("printing")))
    await note("start of another run", link.start(RUNS[1], first, USER))
    await note("report of the refused run", _state(link, RUNS[1]))
    await note("still shown", news.until(_prints("printing")))
    await link.cancel(USER)
    await note("cancelled", news.until(_ended("idle", RUNS[0])))
    await note("report", _state(link, RUNS[0]))
    await note("start of an ended run", link.start(RUNS[0], first, USER))
    await note("nothing started", news.until(_ended("idle", RUNS[0])))
    await link.start(RUNS[2], first, USER)
    await news.until(_prints("printing"))
    await link.stop(USER)
    await note("stopped", news.until(_ended("halted", RUNS[2])))
    await note("report", _state(link, RUNS[2]))
    await bench.restart()
    await note("after the restart", news.until(_ended("idle", RUNS[2])))
    seen.append(("reports", [await _state(link, run) for run in RUNS]))
    await note("start of an ended run", link.start(RUNS[2], first, USER))
    large = bench.too_large()
    digest = hashlib.sha256(large.read_bytes()).hexdigest()
    await note("upload to a full card", link.upload(large, "large.gcode", digest))
    return seen


async def _outcome(done: Awaitable[Any]) -> Any:
    """What a call returns, or the name of its error."""
    try:
        return await done
    except (Refused, Unreachable) as error:
        return type(error).__name__


async def _state(link: Link, run: str) -> str | None:
    report = await link.report(run)
    return None if report is None else report.state


def _number(run: str) -> int:
    return RUNS.index(run)


def _prints(state: str) -> Callable[[Summary], Any]:
    """The print that the hub sees, if the printer is in this state."""

    def found(seen: Summary) -> Any:
        if seen.state != state or seen.job is None:
            return None
        return seen.state, _number(seen.job.run), seen.job.file.endswith("part.gcode")

    return found


def _ended(state: str, run: str) -> Callable[[Summary], Any]:
    """The last print that the hub sees, if it is of this run, and the printer in this state."""

    def found(seen: Summary) -> Any:
        last = seen.last_print
        if seen.state != state or last is None or last.run != run or seen.job is not None:
            return None
        return seen.state, last.result, _number(last.run)

    return found


class _News:
    def __init__(self, bench: Bench) -> None:
        self._bench = bench

    async def until(self, condition: Callable[[Summary], Any]) -> Any:
        """What the condition finds in a summary of the feed, at the latest after a minute."""
        found = asyncio.get_running_loop().create_future()
        shown: list[Summary] = []

        def seen(summary: Summary) -> None:
            shown.append(summary)
            if not found.done() and (value := condition(summary)) is not None:
                found.set_result(value)

        async def follow() -> None:
            while True:
                try:
                    await self._bench.link.follow(seen)
                except Unreachable:
                    await asyncio.sleep(0.05)

        following = asyncio.create_task(follow())
        try:
            async with asyncio.timeout(_EACH_S):
                return await found
        except TimeoutError:
            return shown[-1:]
        finally:
            following.cancel()
