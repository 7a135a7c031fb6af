"""Who may do what: roles, log-ins, keys, and requests that another web page has caused."""

import asyncio
import re
from dataclasses import dataclass

import pytest
from starlette.websockets import WebSocketDisconnect
from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import HOST, Clock, accounts, client, local_client, site

from passo.web import openapi
from passo.web.accounts.accounts import FRESH_S, IDLE_S, MAX_AGE_S
from passo.web.operations import OPERATIONS
from passo.web.pages import page_routes
from passo.web.roles import Role
from passo.web.slicers import octoprint_socket

API = "/api/v1"
FEED = f"ws://{HOST}{API}/feed"
SOCKETS = f"{API}/feed", f"{API}/summary/feed", octoprint_socket.PATH
ADA = {"name": "Ada", "password": "correct horse"}
HEADERS = {"X-Passo-Request": "1"}
ROLES = [Role.VIEWER, Role.OPERATOR, Role.ADMIN]


@dataclass
class Served:
    """A printer with an account for each role, and a key for each."""

    bridge: FakeBridge
    kept: object
    clock: Clock
    keys: dict

    def as_role(self, role):
        """A client that is logged in."""
        web = client(self.app())
        web.headers |= HEADERS
        if role > Role.PUBLIC:
            answer = web.post(f"{API}/session", json=self.log_in(role))
            assert answer.status_code == 200
        return web

    @staticmethod
    def log_in(role):
        return {"name": str(role), "password": f"password of {role}"}

    def app(self, **options):
        return site(self.bridge, self.kept, **options)


@pytest.fixture(scope="module")
def served():
    clock = Clock()
    kept, keys = accounts(clock=clock), {}

    async def fill():
        await kept.create_administrator("admin", "password of admin", "address", None)
        for role in ROLES[:2]:
            await kept.add(str(role), f"password of {role}", role)
        for role in ROLES:
            keys[role] = (await kept.add_key(f"key of {role}", role))[1]

    asyncio.run(fill())
    return Served(FakeBridge(), kept, clock, keys)


def request(web, operation, **options):
    path = re.sub(r"\{\w+\}", "x", operation.template)
    return web.request(operation.method, path, **options)


@pytest.fixture(scope="module")
def by_role(served):
    return {role: served.as_role(role) for role in [Role.PUBLIC, *ROLES]}


@pytest.fixture(scope="module")
def by_key(served):
    """A client without a session: each request has a key."""
    return client(served.app())


@pytest.mark.parametrize("operation", OPERATIONS, ids=lambda operation: operation.name)
def test_operation_is_for_its_role_and_above(served, by_role, by_key, operation):
    for role in (Role.PUBLIC, *ROLES):
        web = served.as_role(role) if operation.verb == "log_out" else by_role[role]
        status = request(web, operation).status_code
        if role >= operation.role:
            assert status not in (401, 403), role
        else:
            assert status == (401 if role is Role.PUBLIC else 403), role
    for role in ROLES:
        headers = {"X-Api-Key": served.keys[role]}
        status = request(by_key, operation, headers=headers).status_code
        by_key.cookies.clear()
        allowed = role >= operation.role and not operation.fresh
        assert (status not in (401, 403)) == allowed, role


def test_every_route_is_an_operation_a_socket_or_a_file_of_the_page():
    application = site(FakeBridge())._app
    paths = {route.path for route in application.routes}
    page = {route.path for route in page_routes()}
    assert paths == {o.path for o in OPERATIONS} | page | {openapi.PATH, *SOCKETS}


def test_every_operation_but_the_first_log_in_needs_one():
    public = {operation.name for operation in OPERATIONS if operation.role is Role.PUBLIC}
    assert public == {
        *("session.get", "session.set_up", "session.log_in", "rrf.connect", "pairing.pair")
    }
    fresh = {operation.name for operation in OPERATIONS if operation.fresh}
    groups = {o.name for o in OPERATIONS if o.group in ("accounts", "keys") and o.writes}
    assert groups <= fresh


def test_this_computer_may_do_all_until_there_is_an_administrator():
    bridge = FakeBridge()
    web = local_client(bridge)
    assert web.post(f"{API}/stop").status_code == 204
    assert web.post(f"{API}/keys", json={"name": "x"}).json()["error"]["code"] == (
        "web.no-administrator"
    )
    assert web.get(f"{API}/session").json()["set_up"] is False
    assert web.post(f"{API}/session/administrator", json=ADA).json()["role"] == "admin"
    assert web.post(f"{API}/stop", headers=HEADERS).status_code == 204
    web.cookies.clear()
    assert web.post(f"{API}/stop").status_code == 401
    assert web.post(f"{API}/session/administrator", json=ADA).status_code == 409


@pytest.mark.parametrize(
    ("loopback", "host", "headers"),
    [
        (False, "127.0.0.1", {}),  # it listens beyond this computer
        (True, "192.168.1.7", {}),
        (True, "127.0.0.1", {"X-Forwarded-For": "192.168.1.7"}),  # a proxy
    ],
)
def test_elsewhere_the_administrator_needs_the_one_time_code(loopback, host, headers):
    kept = accounts()
    web = client(site(FakeBridge(), kept, loopback=loopback), host)
    assert web.get(f"{API}/status", headers=headers).status_code == 401
    assert web.get(f"{API}/session", headers=headers).json()["code_needed"] is True
    place = f"{API}/session/administrator"
    for code in ("", "AAAAA-AAAAA"):
        answer = web.post(place, json={**ADA, "code": code}, headers=headers)
        assert (answer.status_code, answer.json()["error"]["code"]) == (401, "web.code")
    answer = web.post(place, json={**ADA, "code": kept.code.lower()}, headers=headers)
    assert answer.status_code == 200
    assert kept.code == ""


def test_cookie_is_kept_from_scripts_and_other_sites(served):
    answer = client(served.app()).post(f"{API}/session", json=served.log_in(Role.VIEWER))
    name, _, attributes = answer.headers["set-cookie"].partition("=")
    assert name == f"passo-{served.kept.instance}"
    assert {"HttpOnly", "SameSite=Strict", "Path=/"} <= set(attributes.split("; "))


def test_cookie_of_another_printer_of_this_computer_counts_for_nothing(served):
    """Browsers send cookies of a host to all of its ports."""
    other = accounts()
    asyncio.run(other.create_administrator("admin", "password of admin", "address", None))
    web = client(site(FakeBridge(), other))
    web.headers |= HEADERS
    web.cookies.update(served.as_role(Role.ADMIN).cookies)
    assert web.get(f"{API}/status").status_code == 401
    assert web.post(f"{API}/session", json=served.log_in(Role.ADMIN)).status_code == 200
    assert len(web.cookies) == 2  # neither log-in has ended the other
    assert web.get(f"{API}/status").status_code == 200
    one = client(served.app())
    one.cookies.update(web.cookies)
    assert one.get(f"{API}/status").status_code == 200


@pytest.mark.parametrize(
    ("headers", "allowed"),
    [
        ({}, False),  # no form of another page can send the header
        (HEADERS, True),
        ({**HEADERS, "Origin": f"http://{HOST}", "Sec-Fetch-Site": "same-origin"}, True),
        ({**HEADERS, "Origin": "http://127.0.0.1:4001"}, False),
        ({**HEADERS, "Origin": "http://evil.example"}, False),
        ({**HEADERS, "Origin": "null"}, False),
        ({**HEADERS, "Sec-Fetch-Site": "cross-site"}, False),
        ({**HEADERS, "Sec-Fetch-Site": "same-site"}, False),
    ],
)
def test_other_pages_cannot_use_a_log_in(served, headers, allowed):
    web = served.as_role(Role.OPERATOR)
    del web.headers["X-Passo-Request"]
    answer = web.post(f"{API}/stop", headers=headers)
    assert answer.status_code == (204 if allowed else 403)
    if not allowed:
        assert answer.json()["error"]["code"] == "web.origin"


def test_other_pages_cannot_use_this_computer_without_account():
    web = local_client(FakeBridge())
    for headers in ({"Origin": "http://evil.example"}, {"Sec-Fetch-Site": "cross-site"}):
        assert web.post(f"{API}/stop", headers=headers).status_code == 403
        assert web.get(f"{API}/status", headers=headers).status_code == 403
        with pytest.raises(WebSocketDisconnect), web.websocket_connect(FEED, headers=headers):
            pass


@pytest.mark.parametrize(
    ("host", "loopback", "status"),
    [
        ("localhost:4000", True, 200),
        ("127.0.0.1", True, 200),
        ("[::1]:4000", True, 200),
        ("printer.lan", True, 200),  # a name that was given
        ("evil.example", True, 403),
        ("localhost.evil.example", True, 403),
        ("192.168.1.5", True, 403),
        ("192.168.1.5:4000", False, 200),
        ("evil.example", False, 403),
        ("", False, 403),
        ("[", False, 403),
    ],
)
def test_host_must_be_a_name_of_this_printer(served, host, loopback, status):
    web = client(served.app(loopback=loopback, names=["printer.lan"]))
    headers = {"Host": host, "X-Api-Key": served.keys[Role.VIEWER]}
    assert web.get(f"{API}/status", headers=headers).status_code == status


def test_origin_of_a_proxy_with_a_given_name_is_ones_own(served):
    app = served.app(names=["printer.example"])
    web = client(app)
    headers = {"Origin": "https://printer.example"}
    answer = web.post(f"{API}/session", json=served.log_in(Role.VIEWER), headers=headers)
    assert answer.status_code == 200
    assert "Secure" in answer.headers["set-cookie"]


def test_answers_cannot_be_framed_or_run_anything(served):
    for path in ("/", f"{API}/session", f"{API}/nothing"):
        headers = client(served.app()).get(path).headers
        policy = headers["content-security-policy"]
        assert "script-src 'self';" in policy
        assert "style-src 'self';" in policy
        assert "frame-ancestors 'none'" in policy
        assert "unsafe" not in policy
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["x-frame-options"] == "DENY"
        assert "access-control-allow-origin" not in headers


def test_failed_log_ins_answer_alike_and_are_limited(served):
    web = client(served.app(), "10.0.0.1")
    wrong = [{"name": "viewer", "password": "wrong"}, {"name": "nobody", "password": "wrong"}]
    answers = [web.post(f"{API}/session", json=body) for body in (*wrong, wrong[0])]
    assert {answer.status_code for answer in answers} == {401}
    assert len({answer.text for answer in answers}) == 1
    limited = web.post(f"{API}/session", json=served.log_in(Role.ADMIN))
    assert (limited.status_code, limited.headers["retry-after"]) == (429, "60")
    served.clock.s += 60
    assert web.post(f"{API}/session", json=served.log_in(Role.ADMIN)).status_code == 200


def test_session_ends_when_it_is_revoked_or_too_old(served):
    web = served.as_role(Role.VIEWER)
    own = next(one["id"] for one in web.get(f"{API}/sessions").json() if one["own"])
    assert web.delete(f"{API}/sessions/{own}").status_code == 204
    assert web.get(f"{API}/status").status_code == 401
    web = served.as_role(Role.VIEWER)
    served.clock.s += IDLE_S - 1
    assert web.get(f"{API}/status").status_code == 200
    served.clock.s += IDLE_S - 1
    assert web.get(f"{API}/status").status_code == 200
    served.clock.s += IDLE_S
    assert web.get(f"{API}/status").status_code == 401
    web = served.as_role(Role.VIEWER)
    for _ in range(int(MAX_AGE_S / IDLE_S * 2)):
        assert web.get(f"{API}/status").status_code == 200
        served.clock.s += IDLE_S / 2
    served.clock.s += IDLE_S / 2
    assert web.get(f"{API}/status").status_code == 401


def test_password_is_asked_for_again_after_five_minutes(served):
    web = served.as_role(Role.ADMIN)
    body = {"name": "slicer", "role": "operator"}
    assert web.post(f"{API}/keys", json=body).status_code == 201
    served.clock.s += FRESH_S
    assert web.post(f"{API}/keys", json=body).json()["error"]["code"] == "web.password"
    wrong = web.post(f"{API}/session/password", json={"password": "wrong"})
    assert wrong.status_code == 401
    password = {"password": "password of admin"}
    assert web.post(f"{API}/session/password", json=password).status_code == 204
    made = web.post(f"{API}/keys", json=body).json()
    script = client(served.app())
    headers = {"X-Api-Key": made["key"]}
    assert script.post(f"{API}/stop", headers=headers).status_code == 204
    assert web.delete(f"{API}/keys/{made['record']['id']}").status_code == 204
    assert script.post(f"{API}/stop", headers=headers).status_code == 401


def test_feed_sends_nothing_without_a_role(served):
    with (
        pytest.raises(WebSocketDisconnect),
        client(served.app()).websocket_connect(FEED),
    ):
        pass
    headers = {"X-Api-Key": served.keys[Role.VIEWER]}
    with client(served.app()).websocket_connect(FEED, headers=headers) as feed:
        assert feed.receive_json()["type"] == "status"
        feed.send_json({"type": "script", "id": 7, "script": "G28"})
        answer = feed.receive_json()
        assert (answer["id"], answer["error"]["code"]) == (7, "web.role")


def test_account_that_changes_loses_its_log_ins(served):
    admin, viewer = served.as_role(Role.ADMIN), served.as_role(Role.VIEWER)
    change = {"password": "another password"}
    assert admin.patch(f"{API}/accounts/viewer", json=change).status_code == 200
    assert viewer.get(f"{API}/status").status_code == 401
    back = {"password": "password of viewer"}
    assert admin.patch(f"{API}/accounts/viewer", json=back).status_code == 200
    last = admin.patch(f"{API}/accounts/admin", json={"role": "viewer"})
    assert last.json()["error"]["code"] == "web.last-administrator"


def test_accounts_are_kept_and_secrets_are_not(tmp_path, caplog):
    clock = Clock()
    kept = accounts(tmp_path, clock)
    web = local_client(FakeBridge(), kept)
    with caplog.at_level("DEBUG", logger="passo"):
        assert web.post(f"{API}/session/administrator", json=ADA).status_code == 200
        key = web.post(f"{API}/keys", json={"name": "slicer"}, headers=HEADERS).json()["key"]
    token = next(iter(web.cookies.values()))
    kept.close()
    again = accounts(tmp_path, clock)
    web = client(site(FakeBridge(), again))
    web.headers |= HEADERS
    web.cookies.set(again.cookie, token)
    assert web.get(f"{API}/session").json()["name"] == "ada"
    assert web.get(f"{API}/session").json()["fresh"] is False
    again.close()
    stored = b"".join(path.read_bytes() for path in tmp_path.iterdir())
    assert b"ada" in stored
    for secret in (ADA["password"], token, key):
        assert secret.encode() not in stored
        assert secret not in caplog.text
    assert {path.stat().st_mode & 0o077 for path in tmp_path.iterdir()} == {0}
