"""The common functions of all slicer interfaces: start a print, run commands, read JSON."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from typing import TYPE_CHECKING, Any, cast

import msgspec

from passo.config.heater_numbers import heater_of
from passo.errors import PassoError, WebError
from passo.printer.status import HeaterStatus, PrinterState, Status
from passo.web.requests import limited

if TYPE_CHECKING:
    from passo.web.bridge import Bridge
    from passo.web.call import Call

_MAX_JSON = 1 << 16
_ANSWER_S = 2.0  # after this time, the client of a running command gets an answer

_going_on = set[asyncio.Task[tuple[str, ...]]]()  # the event loop has only weak references


async def started(bridge: Bridge, path: str) -> bool:
    """Starts the print of a file. Returns False if the printer cannot print now."""
    try:
        await bridge.start_print(path)
    except PassoError:
        return False
    return True


async def run_soon(call: Call, script: str) -> tuple[str, ...]:
    """Executes lines of G-code, and returns their answers, as `soon` does."""
    return await soon(call.run(script))


async def soon(commands: Coroutine[Any, Any, tuple[str, ...]]) -> tuple[str, ...]:
    """Returns the answers of commands within `_ANSWER_S`; commands that take longer continue
    afterwards. Raises PassoError for a failure within that time."""
    task = asyncio.ensure_future(commands)
    _going_on.add(task)
    task.add_done_callback(_ended)
    done, _ = await asyncio.wait({task}, timeout=_ANSWER_S)
    return task.result() if done else ()


def _ended(task: asyncio.Task[tuple[str, ...]]) -> None:
    _going_on.discard(task)
    if not task.cancelled():
        task.exception()  # consoles have shown the error


async def posted(call: Call) -> dict[str, Any]:
    """The JSON object of a request, empty without a body. Raises WebError."""
    data = await limited(call.request, _MAX_JSON)
    try:
        found: object = msgspec.json.decode(data) if data.strip() else {}
    except (msgspec.DecodeError, RecursionError, UnicodeDecodeError) as error:
        raise WebError.of("web.malformed", value=error) from None
    if not isinstance(found, dict):
        raise WebError.of("web.malformed", value="expected an object")
    return cast("dict[str, Any]", found)


def heaters(bridge: Bridge, status: Status, kind: str) -> list[HeaterStatus]:
    """The heaters of a kind, by their numbers in commands."""
    machine = bridge.machine
    names = (heater_of(machine, kind, i) for i in range(len(machine.heaters) + len(machine.tools)))
    return [status.heaters[name] for name in dict.fromkeys(names) if name in status.heaters]


def is_printing(status: Status) -> bool:
    """Whether a print from a file is running or paused."""
    return status.state in (PrinterState.PRINTING, PrinterState.PAUSED)


def sentence(error: PassoError) -> str:
    """The error as one sentence, and the next action."""
    return str(error.problems[0])
