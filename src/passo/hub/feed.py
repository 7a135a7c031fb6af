"""The feed of the hub: the farm, then its changes, at most once a second."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING

import msgspec
from anyio import create_task_group
from msgspec import Raw, Struct
from starlette.websockets import WebSocketDisconnect

from passo.errors import PassoError
from passo.hub.limits import Limits, Tags, seen
from passo.hub.views import Farm, PowerGroup, PrinterView
from passo.web.answers import refusal
from passo.web.roles import Role

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

    from passo.hub.control import FarmControl
    from passo.web.access import Access
    from passo.web.operation import Caller

INTERVAL_S = 1.0  # between two messages
BUDGET = 80_000  # bytes of printers in one message; the others follow in the next one
_MOST_WAITING = 4  # messages for a client that reads too slowly: then it gets the whole farm again
_RIGHTS_EVERY_S = 5.0
_NOT_ALLOWED = 1008  # "policy violation" (IANA, WebSocket close codes)


class Whole(Struct, tag_field="type", tag="farm"):
    """The first message: the whole farm."""

    farm: Farm


class Changes(Struct, tag_field="type", tag="changes"):
    """What has changed since the last message: whole printers and jobs; the ids that are `gone`, of
    either; the groups, null if they are as before."""

    printers: list[Raw]
    jobs: list[Raw]
    groups: tuple[PowerGroup, ...] | None
    gone: list[str]
    queue_paused: bool


class _Client:
    """The messages that wait for one client."""

    def __init__(self) -> None:
        self.waiting: deque[str] = deque()
        self.news = asyncio.Event()
        self.behind = True  # the whole farm comes next

    def put(self, message: str) -> None:
        """Adds a message; too many become the whole farm."""
        if len(self.waiting) == _MOST_WAITING:
            self.waiting.clear()
            self.behind = True
        if not self.behind:
            self.waiting.append(message)
        self.news.set()


class Audience:
    """All clients that see the same part of the farm. `shown` is what they have."""

    def __init__(self, farm: Farm) -> None:
        self._encoder = msgspec.json.Encoder()
        self.clients: set[_Client] = set()
        self._show(farm)

    def _show(self, farm: Farm) -> None:
        self._printers = {printer.id: printer for printer in farm.printers}
        self._jobs = {job.id: job for job in farm.jobs}
        self._groups, self._paused = farm.groups, farm.queue_paused

    def whole(self) -> str:
        """The first message of a client."""
        printers, jobs = tuple(self._printers.values()), tuple(self._jobs.values())
        farm = Farm(printers, jobs, self._groups, self._paused)
        return self._encoder.encode(Whole(farm)).decode()

    def changes(self, farm: Farm) -> tuple[str, bool]:
        """The next message, empty if nothing has changed; and whether all changes are in it. Those
        that need a user come first, and of the others those that are the oldest."""
        now = {printer.id: printer for printer in farm.printers}
        jobs = {job.id: job for job in farm.jobs}
        gone = [*(self._printers.keys() - now.keys()), *(self._jobs.keys() - jobs.keys())]
        changed = [one for one in farm.printers if self._printers.get(one.id) != one]
        chosen, complete = self._within_budget(changed)
        changed_jobs = [job for id, job in jobs.items() if self._jobs.get(id) != job]
        groups = None if farm.groups == self._groups else farm.groups
        paused = self._paused != farm.queue_paused
        if not (gone or chosen or changed_jobs or groups is not None or paused):
            return "", True
        message = Changes(
            [raw for _, raw in chosen],
            [Raw(self._encoder.encode(job)) for job in changed_jobs],
            groups,
            gone,
            farm.queue_paused,
        )
        # What has just been shown goes to the end, so that the oldest come first.
        kept = {id: shown for id, shown in self._printers.items() if id in now}
        for printer, _ in chosen:
            kept.pop(printer.id, None)
            kept[printer.id] = printer
        self._printers, self._jobs = kept, jobs
        self._groups, self._paused = farm.groups, farm.queue_paused
        return self._encoder.encode(message).decode(), complete

    def _within_budget(
        self, changed: list[PrinterView]
    ) -> tuple[list[tuple[PrinterView, Raw]], bool]:
        place = {id: number for number, id in enumerate(self._printers)}
        changed.sort(key=lambda one: (not self._urgent(one), place.get(one.id, -1)))
        chosen: list[tuple[PrinterView, Raw]] = []
        size = 0
        for printer in changed:
            raw = self._encoder.encode(printer)
            size += len(raw)
            if chosen and size > BUDGET:
                return chosen, False
            chosen.append((printer, Raw(raw)))
        return chosen, True

    def _urgent(self, now: PrinterView) -> bool:
        """Whether more than temperatures and progress have changed."""
        before = self._printers.get(now.id)
        return before is None or _without_progress(before) != _without_progress(now)


def _without_progress(printer: PrinterView) -> tuple[object, ...]:
    seen = printer.seen
    shown = seen and (seen.state, seen.job and seen.job.run, seen.last_print, seen.fault)
    return (
        *(printer.name, printer.condition, printer.bed_clear, printer.attention, printer.run),
        *(printer.tags, printer.loaded, printer.service, printer.service_due, shown),
    )


class FarmFeed:
    """Sends the farm to all clients. Each message is made once for all who see the same printers.
    Use it only in the web's event loop."""

    def __init__(self, farm: FarmControl, limits: Limits, access: Access) -> None:
        self._farm, self._limits, self._access = farm, limits, access
        self._audiences: dict[Tags | None, Audience] = {}
        self._changed = asyncio.Event()
        self._task: asyncio.Task[None] | None = None
        self._end: Callable[[], None] = lambda: None

    async def serve(self, websocket: WebSocket) -> None:
        """Serves a client that has the right to see the farm, until it disconnects or loses that
        right."""
        try:
            caller = self._access.caller(websocket, writes=False)
            self._access.require(caller, Role.VIEWER)
        except PassoError as error:
            await websocket.send_denial_response(refusal(error))
            return
        await websocket.accept()
        tags, client = self._limits.of(caller), _Client()
        audience = self._join(tags, client)
        try:
            async with create_task_group() as group:

                async def receive() -> None:
                    with suppress(WebSocketDisconnect, KeyError):
                        while True:
                            await websocket.receive_text()
                    group.cancel_scope.cancel()

                group.start_soon(receive)
                with suppress(WebSocketDisconnect):
                    await self._send(websocket, client, audience, caller, tags)
                group.cancel_scope.cancel()
        finally:
            self._leave(tags, client)

    async def _send(
        self,
        websocket: WebSocket,
        client: _Client,
        audience: Audience,
        caller: Caller,
        tags: Tags | None,
    ) -> None:
        while self._access.holds(caller) and self._limits.of(caller) == tags:
            if client.behind:
                client.behind = False
                await websocket.send_text(audience.whole())
            elif client.waiting:
                await websocket.send_text(client.waiting.popleft())
            else:
                client.news.clear()
                with suppress(TimeoutError):  # to look at the rights
                    async with asyncio.timeout(_RIGHTS_EVERY_S):
                        await client.news.wait()
        await websocket.close(_NOT_ALLOWED)

    def send_changes(self) -> bool:
        """Sends all changes to all clients; returns whether nothing is left."""
        farm, complete = self._farm.view(), True
        for tags, audience in self._audiences.items():
            message, done = audience.changes(seen(farm, tags))
            complete &= done
            if message:
                for client in audience.clients:
                    client.put(message)
        return complete

    def _join(self, tags: Tags | None, client: _Client) -> Audience:
        if not self._audiences:
            self._end = self._farm.listen(self._changed.set)
            self._task = asyncio.get_running_loop().create_task(self._run())
        if tags not in self._audiences:
            self._audiences[tags] = Audience(seen(self._farm.view(), tags))
        self._audiences[tags].clients.add(client)
        return self._audiences[tags]

    def _leave(self, tags: Tags | None, client: _Client) -> None:
        audience = self._audiences[tags]
        audience.clients.discard(client)
        if not audience.clients:
            del self._audiences[tags]
        if not self._audiences and self._task is not None:
            self._end()
            self._task.cancel()
            self._task = None

    async def _run(self) -> None:
        while True:
            await self._changed.wait()
            self._changed.clear()
            if not self.send_changes():
                self._changed.set()
            await asyncio.sleep(INTERVAL_S)
