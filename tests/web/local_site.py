"""The web interface of a fake bridge, as a test client on this computer sees it."""

from __future__ import annotations

from starlette.testclient import TestClient

from passo.web.access import Binding
from passo.web.accounts.accounts import Accounts
from passo.web.accounts.store import Store
from passo.web.app import web_app
from passo.web.logs import Logs
from passo.web.temperature_history import TemperatureHistory

HOST = "127.0.0.1:4000"
ID = "7d444840-9dc0-11d1-b245-5ffdce74fad2"


class Clock:
    """Fake time: of the wall and monotonic."""

    def __init__(self) -> None:
        self.s = 1_800_000_000.0

    def __call__(self) -> float:
        return self.s


def accounts(folder=None, clock=None):
    clock = clock or Clock()
    return Accounts(Store(folder), wall_s=clock, now_s=clock)


def site(bridge, kept=None, temperatures=None, logs=None, *, loopback=True, names=(), state=None):
    """The application that `passo serve` serves, with accounts in memory unless some are given."""
    binding = Binding(loopback, frozenset(names))
    past = temperatures or TemperatureHistory()
    kept = kept or accounts()
    return web_app(bridge, kept, binding, past, logs or Logs(), printer_id=ID, state=state)


def local_client(bridge, kept=None):
    """A client on this computer, where all is allowed until there is an administrator."""
    return client(site(bridge, kept))


def client(app, host="127.0.0.1"):
    """A client at an address."""
    return TestClient(app, f"http://{HOST}", client=(host, 50000))
