"""Pairing: a program gets a key of this printer with a one-time code."""

import asyncio
import logging

import pytest
from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import ID, Clock, accounts, client, local_client, site
from tests.web.test_runs_api import code_of

API = "/api/v1"
ADA = {"name": "ada", "password": "correct horse"}


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def printer(clock):
    """A printer in the network with an administrator, for a client of any address."""
    kept = accounts(clock=clock)
    asyncio.run(kept.create_administrator("ada", "correct horse", "address", None))
    app = site(FakeBridge(), kept, loopback=False)
    return lambda host="192.168.1.9": client(app, host)


def code(printer):
    web = printer()
    web.headers["X-Passo-Request"] = "1"
    assert web.post(f"{API}/session", json=ADA).status_code == 200
    made = web.post(f"{API}/pairing").json()
    assert made["expires_s"] == 600
    return made["code"]


def pair(web, text):
    return web.post(f"{API}/pair", json={"name": "farm", "code": text})


def test_a_code_makes_one_key_of_an_operator(printer):
    text, hub = code(printer), printer("192.168.1.20")
    paired = pair(hub, text.lower()).json()
    assert (paired["id"], paired["name"]) == (ID, "i3")
    headers = {"X-Api-Key": paired["key"]}
    me = hub.get(f"{API}/session", headers=headers).json()
    assert (me["name"], me["role"]) == ("farm", "operator")
    assert hub.get(f"{API}/summary", headers=headers).json()["id"] == ID
    again = pair(hub, text)
    assert (again.status_code, code_of(again)) == (401, "web.pairing")
    assert hub.post(f"{API}/pairing", headers=headers).status_code == 403


def test_a_code_ends_after_ten_minutes_and_with_the_next(printer, clock):
    old = code(printer)
    new = code(printer)
    assert pair(printer("10.0.0.1"), old).status_code == 401
    clock.s += 599
    assert pair(printer("10.0.0.2"), new).status_code == 200
    last = code(printer)
    clock.s += 600
    assert pair(printer("10.0.0.3"), last).status_code == 401
    assert pair(printer("10.0.0.3"), "").status_code == 401


def test_wrong_codes_are_limited_by_address_and_end_the_code(printer):
    text = code(printer)
    answers = [pair(printer("10.0.0.1"), "AAAAA-AAAAA").status_code for _ in range(4)]
    assert answers == [401, 401, 401, 429]
    assert pair(printer("10.0.0.2"), "AAAAA-AAAAA").status_code == 401
    assert pair(printer("10.0.0.3"), "AAAAA-AAAAA").status_code == 401  # the fifth
    assert pair(printer("10.0.0.4"), text).status_code == 401


def test_programs_of_this_computer_need_no_code_before_accounts():
    web = local_client(FakeBridge())
    assert pair(web, "").json()["id"] == ID
    in_network = client(site(FakeBridge(), loopback=False), "192.168.1.20")
    assert code_of(pair(in_network, "")) == "web.pairing"


def test_a_program_names_its_user(printer, caplog):
    bridge = FakeBridge()
    kept = accounts()
    asyncio.run(kept.create_administrator("ada", "correct horse", "address", None))
    key = asyncio.run(kept.add_key("farm", 2))[1]
    web = client(site(bridge, kept))
    caplog.set_level(logging.INFO, "passo.web")

    def run(user):
        headers = {"X-Api-Key": key, "X-Passo-User": user}
        web.post(f"{API}/console", json={"script": "M105"}, headers=headers)
        web.post(f"{API}/job/start", json={"path": "a.gcode"}, headers=headers)

    for user in ("anna", "J%C3%B6rg", " \t", "x" * 100):
        run(user)
    names = ["farm (anna)", "farm (Jörg)", "farm", f"farm ({'x' * 64})"]
    assert bridge.senders == names
    assert [line for line in caplog.messages if "job" in line] == [
        f"job.start by {name}" for name in names
    ]
