"""The table of commands is what the printer knows, and what it does."""

import re

import pytest
from tests.support.scenario import Scenario

from passo.gcode.dialect import BY_CODE, TABLE, Kind, When


@pytest.fixture(scope="module")
def printer():
    with Scenario("i3") as s:
        yield s.printer


def codes(kinds, *whens):
    return {r.code for r in TABLE if r.kind not in kinds and r.when in whens}


def test_every_handler_has_a_row_of_its_kind(printer):
    for code in printer.dispatch.immediate:
        assert BY_CODE[code].when in (When.IMMEDIATE, When.AHEAD), code
    # M220, M221 and M290 of a program keep their places among the moves; M112 and M410 in a file,
    # or behind another command, act in their turn.
    for code in set(printer.dispatch.planned) - {"M220", "M221", "M290", "M112", "M410"}:
        assert BY_CODE[code].when in (When.PLANNED, When.EXCLUSIVE), code


def test_every_row_of_a_console_has_a_handler(printer):
    handled = {*printer.dispatch.immediate, *printer.dispatch.planned, "M410"}
    rows = {r.code for r in TABLE if r.when in (When.IMMEDIATE, When.AHEAD)}
    assert rows <= handled


@pytest.mark.parametrize(
    "code", [r.code for r in TABLE if r.kind is not Kind.MOTION and re.match(r"[GM]\d", r.code)]
)
def test_no_row_is_unknown_to_a_console(code):
    if code in ("M112", "M0", "M1", "M303", "M600", "M601", "M2", "M30"):
        return
    with Scenario("i3") as s:
        answer = s.host.ok(code, 60)
        assert not any("Unknown command" in line for line in answer)
