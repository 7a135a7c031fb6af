"""The page is served as it was built, with headers that keep others out of it."""

import gzip

import pytest
from starlette.applications import Starlette
from starlette.testclient import TestClient

from passo.web.pages import page_routes


@pytest.fixture
def built(tmp_path):
    assets = tmp_path / "assets"
    assets.mkdir()
    (tmp_path / "index.html").write_text("<!doctype html>")
    (tmp_path / ".sources").write_text("stamp")
    (assets / "index-1a2b.js").write_text("let x;")
    (assets / "index-1a2b.js.gz").write_bytes(gzip.compress(b"let x;"))
    return tmp_path


@pytest.fixture
def web(built):
    return TestClient(Starlette(routes=page_routes(built)))


def test_index_is_revalidated_each_time(web):
    answer = web.get("/")
    assert answer.text == "<!doctype html>"
    assert answer.headers["cache-control"] == "no-cache"
    again = web.get("/", headers={"If-None-Match": answer.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")


def test_names_with_a_hash_are_kept_for_ever(web):
    answer = web.get("/assets/index-1a2b.js")
    assert answer.headers["cache-control"] == "public, max-age=31536000, immutable"
    assert answer.headers["content-type"] == "text/javascript; charset=utf-8"


@pytest.mark.parametrize(("accepted", "encoding"), [("gzip", "gzip"), ("identity", None)])
def test_file_is_sent_as_the_client_can_read_it(web, accepted, encoding):
    answer = web.get("/assets/index-1a2b.js", headers={"Accept-Encoding": accepted})
    assert answer.text == "let x;"
    assert answer.headers.get("content-encoding") == encoding
    assert answer.headers["vary"] == "Accept-Encoding"


def test_other_files_are_not_served(web):
    for path in ("/.sources", "/assets/index-1a2b.js.gz", "/assets/", "/../pages.py"):
        assert web.get(path).status_code == 404


def test_missing_page_explains_how_to_build_it(tmp_path):
    web = TestClient(Starlette(routes=page_routes(tmp_path / "none")))
    assert "make web" in web.get("/").text
