"""Klipper's methods and objects of one printer, for the clients of the API socket. The engine does
no input or output itself; the bridge connects it to the printer."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Awaitable, Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from passo.errors import ConfigError
from passo.events import Message, RemoteCall
from passo.printer.klipper.machine import webhooks
from passo.version import __version__
from passo.web.klippy.arguments import Arguments, RequestError
from passo.web.klippy.connection import Connection
from passo.web.klippy.objects import PrinterObjects
from passo.web.klippy.output import failed
from passo.web.klippy.scripts import Scripts
from passo.web.klippy.subscriptions import Subscription, picked

if TYPE_CHECKING:
    from passo.events import Event
    from passo.printer.status import PrinterState
    from passo.web.bridge import Bridge, Snapshot

_Result = Mapping[str, Any]
_Method = Callable[[Connection, Arguments], Awaitable[_Result]]
# Moonraker serves the folders config and docs of this one
_PUBLISHED = Path(__file__).parent / "published"
_FAILED = ("shutdown", "error")


class Engine:
    """Klipper's methods, objects and messages for all clients of one printer. `on_restart` is
    called when the connections must end because the printer restarts. Its argument is True if the
    caller must restart the printer."""

    def __init__(
        self,
        bridge: Bridge,
        on_restart: Callable[[bool], None],
        *,
        now_s: Callable[[], float],
        log_file: str | None = None,
    ) -> None:
        self._bridge, self._on_restart, self._now_s = bridge, on_restart, now_s
        self._log_file = log_file
        self._objects = PrinterObjects(bridge)
        self._scripts = Scripts(bridge, self._broadcast)
        self._state: str = webhooks(bridge.latest().status)["state"]
        self._has_failed = self._state in _FAILED
        # the state that was sent last, and whether there was no print
        self._does: tuple[PrinterState, bool] | None = None
        self.connections: list[Connection] = []
        self._methods: dict[str, _Method] = {
            "info": self._info,
            "list_endpoints": self._list_endpoints,
            "register_remote_method": self._register_remote_method,
            "objects/list": self._list_objects,
            "objects/query": self._query_objects,
            "objects/subscribe": self._subscribe_objects,
            "gcode/script": self._script,
            "gcode/help": self._help,
            "gcode/subscribe_output": self._subscribe_output,
            "gcode/restart": self._restart,
            "gcode/firmware_restart": self._firmware_restart,
            "emergency_stop": self._emergency_stop,
            "pause_resume/pause": partial(self._line, "PAUSE"),
            "pause_resume/resume": partial(self._line, "RESUME"),
            "pause_resume/cancel": partial(self._line, "CANCEL_PRINT"),
            "query_endstops/status": self._query_endstops,
        }

    # -- events -----------------------------------------------------------------------------

    def on_snapshot(self, snapshot: Snapshot) -> None:
        """Like `Listener.on_snapshot`. Even a state that is shorter than the interval of messages
        is sent, because clients count prints by it."""
        status = snapshot.status
        does, self._does = self._does, (status.state, status.job is None)
        if self._does != does:
            self.tell_changes(snapshot)
        state = webhooks(status)["state"]
        if state == self._state:
            return
        self._state = state
        self._broadcast(f"// Klipper state: {state.capitalize()}")
        if self._has_failed and state == "ready":
            self._on_restart(False)  # clients expect a new connection after a restart
        self._has_failed = self._has_failed or state in _FAILED

    def on_event(self, event: Event) -> None:
        """Like `Listener.on_event`."""
        if isinstance(event, Message):
            self._scripts.hear(event.text)
        elif isinstance(event, RemoteCall):
            self._call_remote(event)

    def tell_changes(self, snapshot: Snapshot | None = None) -> None:
        """Sends each client the changes of its subscribed objects: in this snapshot or, without
        one, up to now."""
        lookup, event_s = self._objects.lookup(snapshot), self._now_s()
        for client in list(self.connections):
            client.tell_changes(lookup, event_s)

    def _call_remote(self, call: RemoteCall) -> None:
        """Calls the method on each client that has registered it."""
        having = [c for c in self.connections if call.method in c.remote_methods]
        for client in having:
            client.tell(client.remote_methods[call.method], call.arguments)
        if not having:
            text = f"A macro calls {call.method}, but no client has registered that method"
            self._broadcast(failed(text))

    def _broadcast(self, line: str) -> None:
        for client in list(self.connections):
            client.tell_output(line)

    # -- requests ---------------------------------------------------------------------------------

    async def answer(self, client: Connection, method: str, arguments: Arguments) -> _Result:
        """Like `Methods.answer`."""
        found = self._methods.get(method)
        if found is None:
            raise RequestError(f"webhooks: No registered callback for path '{method}'")
        return await found(client, arguments)

    async def _info(self, _: Connection, __: Arguments) -> _Result:
        log_file = {} if self._log_file is None else {"log_file": self._log_file}
        return {
            **webhooks(self._bridge.latest().status),
            "hostname": socket.gethostname(),
            "klipper_path": str(_PUBLISHED),
            "python_path": sys.executable,
            "process_id": os.getpid(),
            "user_id": os.getuid(),
            "group_id": os.getgid(),
            # Not a plain version number, which clients would compare with Klipper's.
            "software_version": f"passo-{__version__}",
            "cpu_info": f"{os.cpu_count()} cores",
            **log_file,
        }

    async def _list_endpoints(self, _: Connection, __: Arguments) -> _Result:
        return {"endpoints": list(self._methods)}

    async def _register_remote_method(self, client: Connection, arguments: Arguments) -> _Result:
        client.remote_methods[arguments.text("remote_method")] = arguments.template()
        return {}

    async def _list_objects(self, _: Connection, __: Arguments) -> _Result:
        return {"objects": self._objects.names}

    async def _query_objects(self, _: Connection, arguments: Arguments) -> _Result:
        status = picked(arguments.wishes(), self._objects.lookup())
        return {"eventtime": self._now_s(), "status": status}

    async def _subscribe_objects(self, client: Connection, arguments: Arguments) -> _Result:
        subscription = Subscription(arguments.wishes(), arguments.template())
        status = subscription.first(self._objects.lookup())
        client.objects = subscription if status else None
        return {"eventtime": self._now_s(), "status": status}

    async def _script(self, _: Connection, arguments: Arguments) -> _Result:
        restart = await self._scripts.run(arguments.text("script"))
        if restart == "RESTART":
            return await self._restart(_, arguments)
        if restart:
            self._on_restart(True)
        return {}

    async def _line(self, line: str, _: Connection, __: Arguments) -> _Result:
        await self._scripts.run(line)
        return {}

    async def _help(self, _: Connection, __: Arguments) -> _Result:
        return {row.code: row.help for row in self._bridge.commands}

    async def _subscribe_output(self, client: Connection, arguments: Arguments) -> _Result:
        client.output = arguments.template()
        return {}

    async def _restart(self, _: Connection, __: Arguments) -> _Result:
        """RESTART: restarts the program with the current machine file, or only the boards if the
        program cannot restart. Raises PassoError during a print, and for a file with errors; then
        the printer continues."""
        try:
            await self._bridge.restart_program()
        except ConfigError as error:
            if error.problems[0].code != "machine.no-restart":
                raise
            self._on_restart(True)
        else:
            self._on_restart(False)
        return {}

    async def _firmware_restart(self, _: Connection, __: Arguments) -> _Result:
        self._on_restart(True)
        return {}

    async def _emergency_stop(self, _: Connection, __: Arguments) -> _Result:
        self._bridge.emergency_stop()
        return {}

    async def _query_endstops(self, _: Connection, __: Arguments) -> _Result:
        states = self._objects.endstops = await self._bridge.endstops()
        return {name: "TRIGGERED" if pressed else "open" for name, pressed in states.items()}
