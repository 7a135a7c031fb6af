"""A printer behind Moonraker, such as one with Klipper.

Moonraker's start carries no id. So a file waits in a folder of its own, and `start` first moves it
into a folder that is named after the run: then what prints, and what is in the history, names the
run. While that folder does not exist, the start was certainly never sent. If it exists, and neither
the printer nor its history knows the file, the start may still be on the way:
StartUnknown, a user must look.
"""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from contextlib import aclosing
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast
from urllib.parse import quote
from uuid import NAMESPACE_URL, uuid4, uuid5

import msgspec
from aiohttp import FormData

from passo.hub.link import PrinterRecord, Refused, RunReport, StartUnknown, Unreachable
from passo.hub.links.http import Exchange, address
from passo.hub.links.moonraker_status import Status, run_of, state_of
from passo.web.summary import Summary

if TYPE_CHECKING:
    from aiohttp import ClientSession

    from passo.hub.wishes import NewPrinter

_FOLDER = "hub"
_PRINTS = 50  # newest prints of the history in which a run is looked for
_OTHER_HASH = 422  # the status of an upload that does not match its checksum
_SUBSCRIBE = 1  # ids of the requests over the WebSocket
_GONE = ("notify_klippy_disconnected", "notify_klippy_shutdown")
_REASONS = {
    "error": "the printer has reported an error",
    "klippy_shutdown": "the printer was shut down",
    "klippy_disconnect": "the printer's program has ended",
    "server_exit": "the printer's Moonraker has ended",
    "interrupted": "the print was interrupted",
}


def _refusal(status: int, content: bytes) -> Exception:
    """Moonraker's own error; without one, something else has answered."""
    try:
        error = msgspec.json.decode(content)["error"]
        text = str(error["message"])
    except (msgspec.DecodeError, KeyError, TypeError):
        return Unreachable(f"an answer with status {status} is not of Moonraker")
    if status == _OTHER_HASH:
        text = "The file has arrived with another content"
    if status in (502, 503, 504):
        return Unreachable(text)
    return Refused(f"moonraker.{status}", text, "Look at the page of the printer")


class MoonrakerLink:
    """One printer; see `Link`."""

    def __init__(self, session: ClientSession, record: PrinterRecord) -> None:
        self._record = record
        self._exchange = Exchange(session, record.url, record.key, _refusal)

    async def follow(self, seen: Callable[[Summary], None]) -> None:
        """Like `Link.follow`."""
        status = Status(self._record.id, self._record.name)
        status.history(await self._history(2))
        objects: dict[str, None] = dict.fromkeys(await self._objects())
        first = _call("printer.objects.subscribe", _SUBSCRIBE, objects=objects)
        shown: Summary | None = None
        async with aclosing(self._exchange.messages("/websocket", first)) as messages:
            async for message in messages:
                await self._take(status, msgspec.json.decode(message))
                if (now := status.summary()) is not None and now != shown:
                    shown = now
                    seen(now)

    async def _take(self, status: Status, message: dict[str, Any]) -> None:
        method = message.get("method")
        if message.get("id") == _SUBSCRIBE:
            if "error" in message:
                raise Unreachable(f"Klipper is not ready: {message['error'].get('message')}")
            status.update(message["result"]["status"])
        elif method == "notify_status_update":
            status.update(message["params"][0])
        elif method == "notify_history_changed":
            status.history(await self._history(2))
        elif method in _GONE:
            status.gone(await self._state_message())
        elif method == "notify_klippy_ready":
            raise Unreachable("Klipper has restarted")  # and has forgotten the subscription

    async def upload(self, content: Path, name: str, sha256: str) -> str:
        """Like `Link.upload`: each upload has a folder of its own."""
        folder = f"{_FOLDER}/{uuid4().hex}"

        def form(pieces: AsyncIterator[bytes]) -> FormData:
            fields = FormData({"root": "gcodes", "path": folder, "checksum": sha256})
            fields.add_field("file", pieces, filename=name, content_type="text/x.gcode")
            return fields

        sent = await self._exchange.send("POST", "/server/files/upload", content, form)
        answer = msgspec.json.decode(sent)
        return str(answer.get("result", answer)["item"]["path"])

    async def start(self, run: str, path: str, user: str) -> None:
        """Like `Link.start`. Raises StartUnknown if a former start may be on its way."""
        try:
            if await self.report(run) is not None:
                return
        except Refused as refusal:
            raise Unreachable(refusal.text) from None  # nothing was sent
        own = f"{_FOLDER}/{run}/{path.rpartition('/')[2]}"
        await self._post("server/files/directory", {"path": f"gcodes/{_FOLDER}/{run}"})
        move = {"source": f"gcodes/{path}", "dest": f"gcodes/{own}"}
        await self._post("server/files/move", move)
        await self._post("printer/print/start", {"filename": own})

    async def report(self, run: str) -> RunReport | None:
        """Like `Link.report`."""
        state = await self._printing(run)
        if state:
            return RunReport(state)
        for job in await self._history(_PRINTS):
            if run_of(job["filename"]) == run:
                return RunReport(state_of(job["status"]), _REASONS.get(job["status"], ""))
        if await self._has_folder(run):
            raise StartUnknown(run)
        return None

    async def pause(self, user: str) -> None:
        """Like `Link.pause`."""
        await self._post("printer/print/pause")

    async def resume(self, user: str) -> None:
        """Like `Link.resume`."""
        await self._post("printer/print/resume")

    async def cancel(self, user: str) -> None:
        """Like `Link.cancel`."""
        await self._post("printer/print/cancel")

    async def stop(self, user: str) -> None:
        """Like `Link.stop`."""
        await self._post("printer/emergency_stop")

    async def machine(self) -> str:
        """Like `Link.machine`: there is none."""
        return ""

    async def picture(self, path: str) -> bytes:
        """Like `Link.picture`: the largest one."""
        pictures = await self._get("server/files/thumbnails", {"filename": path})
        if not pictures:
            return b""
        largest = max(pictures, key=lambda one: one["width"] * one["height"])
        place = quote(largest["thumbnail_path"])
        return await self._exchange.ask("GET", f"/server/files/gcodes/{place}")

    async def close(self) -> None:
        """Like `Link.close`. The connections belong to all links."""

    async def _printing(self, run: str) -> str:
        """`printing` or `paused` if Klipper prints the file of a run now, else an empty text."""
        query = {"print_stats": "", "webhooks": ""}
        objects = (await self._get("printer/objects/query", query))["status"]
        stats = objects["print_stats"]
        if objects["webhooks"]["state"] != "ready" or run_of(stats.get("filename") or "") != run:
            return ""  # a halted Klipper shows its last state
        return str(stats["state"]) if stats["state"] in ("printing", "paused") else ""

    async def _has_folder(self, run: str) -> bool:
        """Whether the folder of a run exists: then its start may have been sent."""
        found = await self._get("server/files/directory", {"path": "gcodes"})
        if all(folder["dirname"] != _FOLDER for folder in found["dirs"]):
            return False
        found = await self._get("server/files/directory", {"path": f"gcodes/{_FOLDER}"})
        return any(folder["dirname"] == run for folder in found["dirs"])

    async def _history(self, limit: int) -> list[dict[str, Any]]:
        query = {"limit": str(limit), "order": "desc"}
        return list((await self._get("server/history/list", query))["jobs"])

    async def _objects(self) -> list[str]:
        """The objects of the printer that the summary needs."""
        found: list[str] = (await self._get("printer/objects/list"))["objects"]
        wanted = ("print_stats", "virtual_sdcard", "webhooks", "idle_timeout", "heater_bed")
        return [one for one in found if one in wanted or one.startswith("extruder")]

    async def _state_message(self) -> str:
        try:
            return str((await self._get("printer/info")).get("state_message", ""))
        except Refused as refusal:
            return refusal.text

    async def _get(self, path: str, query: dict[str, str] | None = None) -> Any:
        return _result(await self._exchange.ask("GET", f"/{path}", query=query))

    async def _post(self, path: str, body: object = None) -> Any:
        return _result(await self._exchange.ask("POST", f"/{path}", body=body))


async def pair(session: ClientSession, wish: NewPrinter) -> PrinterRecord:
    """Asks Moonraker for its id and the name of its computer. Raises HubError, Unreachable and
    Refused, for example without a key for a caller that Moonraker does not trust."""
    url = address(wish.url)
    exchange = Exchange(session, url, wish.key, _refusal)
    info = _result(await exchange.ask("GET", "/printer/info"))
    try:
        query = {"namespace": "moonraker", "key": "instance_id"}
        answer = await exchange.ask("GET", "/server/database/item", query=query)
        id = str(_result(answer)["value"])
    except (Refused, KeyError):
        id = str(uuid5(NAMESPACE_URL, url))
    name = wish.name or str(info.get("hostname") or url)
    return PrinterRecord(id, name, url, "moonraker", wish.key)


def _call(method: str, id: int, **parameters: object) -> str:
    call = {"jsonrpc": "2.0", "method": method, "params": parameters, "id": id}
    return msgspec.json.encode(call).decode()


def _result(content: bytes) -> Any:
    try:
        return cast("dict[str, Any]", msgspec.json.decode(content))["result"]
    except (msgspec.DecodeError, KeyError, TypeError):
        raise Unreachable("an answer is not of Moonraker") from None
