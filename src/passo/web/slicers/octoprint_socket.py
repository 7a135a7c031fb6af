"""OctoPrint's WebSocket: sends the state of the printer and of its print when they change, and the
ends of prints. Source: OctoPrint's documentation of its push updates."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any, cast

import msgspec
from anyio import create_task_group
from starlette.websockets import WebSocketDisconnect

from passo.errors import PassoError
from passo.events import JobEnded, StateChanged
from passo.printer.status import PrinterState
from passo.web.answers import refusal
from passo.web.roles import Role
from passo.web.slicers.octoprint_login import NAME, VERSION
from passo.web.slicers.octoprint_status import job_state, printer_state, state_text

if TYPE_CHECKING:
    from anyio.abc import TaskGroup
    from starlette.websockets import WebSocket

    from passo.events import Event
    from passo.web.feeds import Feeds
    from passo.web.operation import Caller
    from passo.web.site import Site

PATH = "/sockjs/websocket"
LOGIN_S = 30.0  # a client that has not logged in by then is disconnected
INTERVAL_S = 0.5  # least time between two states; the client may ask for a multiple
SILENCE_S = 4.0  # a state that has not changed is sent again after this time, at the next wake
_MAX_THROTTLE = 120
_MAX_WAITING = 100  # events for a slow client
_ENDS = {"done": "PrintDone", "cancelled": "PrintCancelled", "failed": "PrintFailed"}
_STATES = {
    PrinterState.PRINTING: "PRINTING",
    PrinterState.PAUSED: "PAUSED",
    PrinterState.HALTED: "ERROR",
}


async def serve_socket(site: Site, feeds: Feeds, websocket: WebSocket) -> None:
    """Serves a client. Before its log-in it receives only the version."""
    try:
        caller = site.access.caller(websocket, writes=False)
    except PassoError as error:  # another web page, or an invalid key
        await websocket.send_denial_response(refusal(error))
        return
    await _Socket(site, feeds, websocket, caller).run()


class _Socket:
    """A client, which logs in with `{"auth": "NAME:SESSION"}` unless the request had a key, or
    needed none."""

    def __init__(self, site: Site, feeds: Feeds, websocket: WebSocket, caller: Caller) -> None:
        self._site, self._feeds, self._websocket = site, feeds, websocket
        self._caller = caller
        self._logged_in = asyncio.Event()
        self._news = asyncio.Event()
        self._events: deque[dict[str, Any]] = deque(maxlen=_MAX_WAITING)
        self._interval_s = INTERVAL_S
        if caller.role >= Role.VIEWER:
            self._logged_in.set()

    def wake(self) -> None:
        """Like `Woken.wake`."""
        self._news.set()

    def on_event(self, event: Event) -> None:
        """Like `Woken.on_event`."""
        if isinstance(event, JobEnded):
            self._events.append(_named(_ENDS[event.outcome], _file(event.file)))
        elif isinstance(event, StateChanged):
            status = self._site.bridge.latest().status
            state = {"state_id": _STATES.get(event.state, "OPERATIONAL")}
            text = state_text(status)
            self._events.append(_named("PrinterStateChanged", {**state, "state_string": text}))

    async def run(self) -> None:
        """Serves the client until it disconnects, or loses the right to see the printer."""
        await self._websocket.accept()
        async with create_task_group() as group:
            group.start_soon(self._receive, group)
            with suppress(WebSocketDisconnect):
                with suppress(TimeoutError):
                    await self._send_all()
                await self._websocket.close()
            group.cancel_scope.cancel()

    async def _receive(self, group: TaskGroup) -> None:
        with suppress(WebSocketDisconnect, KeyError):  # KeyError: the message is not text
            while True:
                await self._take(await self._websocket.receive_text())
        group.cancel_scope.cancel()

    async def _take(self, received: str) -> None:
        try:
            found: object = msgspec.json.decode(received)
        except msgspec.DecodeError:
            return
        message = cast("dict[str, object]", found) if isinstance(found, dict) else {}
        if isinstance(throttle := message.get("throttle"), int):
            self._interval_s = INTERVAL_S * min(max(throttle, 1), _MAX_THROTTLE)
        if isinstance(auth := message.get("auth"), str):
            caller = self._site.octoprint_sessions.caller(auth.rpartition(":")[2])
            if caller is None or not self._site.access.holds(caller):
                await self._send("reauthRequired", {"reason": "stale"})
                return
            self._caller = caller
            self._logged_in.set()

    async def _send_all(self) -> None:
        about = {"version": VERSION, "display_version": NAME, "safe_mode": False, "online": True}
        await self._send("connected", {**about, "debug": False, "permissions": []})
        async with asyncio.timeout(LOGIN_S):
            await self._logged_in.wait()
        leave = self._feeds.join(self)
        try:
            await self._send("history", self._state())
            await self._send_states(asyncio.get_running_loop().time)
        finally:
            leave()

    async def _send_states(self, now_s: Callable[[], float]) -> None:
        sent: dict[str, Any] = {}
        sent_s = now_s()
        while self._site.access.holds(self._caller):
            while self._events:
                await self._send("event", self._events.popleft())
            if (state := self._state()) != sent or now_s() >= sent_s + SILENCE_S:
                sent, sent_s = state, now_s()
                await self._send("current", sent)
            await asyncio.sleep(self._interval_s)
            await self._news.wait()
            self._news.clear()

    def _state(self) -> dict[str, Any]:
        printer, job = printer_state(self._site.bridge), job_state(self._site.bridge)
        z = self._site.bridge.latest().status.position_mm.get("z")
        return {
            "state": printer["state"],
            "temps": [printer["temperature"]],
            "job": job["job"],
            "progress": job["progress"],
            "currentZ": z,
            "offsets": {},
            "logs": [],
            "messages": [],
        }

    async def _send(self, kind: str, payload: dict[str, Any]) -> None:
        await self._websocket.send_text(msgspec.json.encode({kind: payload}).decode())


def _named(kind: str, payload: dict[str, Any]) -> dict[str, Any]:
    return {"type": kind, "payload": payload}


def _file(path: str) -> dict[str, Any]:
    return {"name": path.rpartition("/")[2], "path": path.removeprefix("/"), "origin": "local"}
