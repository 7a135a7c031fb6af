"""How a printer starts and ends: what a first console hears, and heaters off whatever fails."""

from __future__ import annotations

import pytest
from tests.console.scenario import Host, Scenario

from passo import config
from passo.board.boards import Boards
from passo.console.printer_console import furnished, welcome
from passo.errors import CardError, PassoError


def welcomed(s: Scenario, host: Host) -> list[str]:
    async def open_it() -> None:
        welcome(s.printer, host.session)

    before = len(host.heard)
    s.run(open_it())
    return host.heard[before:]


def test_the_first_console_is_told_why_settings_are_not_used(tmp_path):
    (tmp_path / "settings.json").write_text("torn")
    with Scenario(state=str(tmp_path)) as s:
        start, name, why = welcomed(s, s.host)
        assert (start, name) == ("start", "echo:Passo, i3")
        assert "stored settings are not used: it is torn" in why
        assert welcomed(s, Host(s)) == ["start", "echo:Passo, i3"]


def test_it_is_told_that_nothing_can_be_kept(tmp_path):
    (tmp_path / "state").write_text("a file, not a directory")
    with Scenario(state=str(tmp_path / "state")) as s:
        told = welcomed(s, s.host)
        assert any(line.startswith("echo:No history of prints") for line in told)
        assert s.host.ok("M105")[-1].startswith("ok T:")


@pytest.fixture
def closed(monkeypatch):
    """How often connections were closed."""
    times: list[Boards] = []
    close = Boards.close

    def counted(self: Boards) -> None:
        times.append(self)
        close(self)

    monkeypatch.setattr(Boards, "close", counted)
    return times


def test_a_card_that_cannot_be_used_lets_go_of_the_board(tmp_path, closed):
    with pytest.raises(CardError):
        Scenario(card=str(tmp_path / "nothing"))
    assert len(closed) == 1


def test_a_board_that_fails_at_once_is_let_go(monkeypatch, closed):
    def fails(*_: object) -> None:
        raise PassoError.of("machine.place-unknown")

    monkeypatch.setattr("passo.printer.watch.driver_status.DriverWatch.begin", fails)
    with pytest.raises(PassoError):
        Scenario()
    assert len(closed) == 1


def test_heaters_go_off_before_all_that_may_fail(closed):
    s = Scenario()
    ended: list[str] = []

    def fails() -> None:
        ended.append("failed" if closed else "too early")
        raise CardError.of("card.absent", value="pulled")

    s.printer.closers += [lambda: ended.append("first opened"), fails]
    with pytest.raises(CardError), s:
        pass
    assert ended == ["failed", "first opened"]
    assert len(closed) == 1


def test_a_machine_is_furnished_within_a_loop_only():
    with pytest.raises(RuntimeError, match="no running event loop"):
        furnished(config.load("i3"))
