"""OctoPrint's interface: the server, and the user whose key a request has. Source: OctoPrint's REST
API documentation."""

from __future__ import annotations

from starlette.responses import Response

from passo.version import __version__
from passo.web.answers import json
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role

VERSION = "1.5.0"  # of OctoPrint, whose requests Passo answers
NAME = f"OctoPrint (Passo {__version__})"  # some slicers check that this begins with OctoPrint


@operation("octoprint.version", "GET", "/api/version", Role.VIEWER, root="")
async def version(_: Call) -> Response:
    """The version."""
    # `upload-by-put` is for clients that treat the printer as PrusaLink.
    can = {"upload-by-put": True}
    return json({"api": "0.1", "server": VERSION, "text": NAME, "capabilities": can})


@operation("octoprint.server", "GET", "/api/server", Role.VIEWER, root="")
async def server(_: Call) -> Response:
    """The version, and no safe mode."""
    return json({"version": VERSION, "safemode": None})


@operation("octoprint.login", "POST", "/api/login", Role.VIEWER, root="")
async def login(call: Call) -> Response:
    """The owner of the key, with a session for the WebSocket `/sockjs/websocket`."""
    session = call.site.octoprint_sessions.begin(call.caller)
    about = {"active": True, "user": True, "admin": call.caller.role >= Role.ADMIN}
    return json({**about, **_user(call), "session": session})


@operation("octoprint.user", "GET", "/api/currentuser", Role.VIEWER, root="")
async def user(call: Call) -> Response:
    """The owner of the key."""
    return json(_user(call))


def _user(call: Call) -> dict[str, object]:
    caller = call.caller
    groups = ["users"] if caller.role < Role.ADMIN else ["admins", "users"]
    return {"name": caller.name, "groups": groups, "permissions": []}
