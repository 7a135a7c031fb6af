"""A card that is absent, released, pulled, or fails."""

import errno
import os

import pytest
from tests.support.card_print import printed
from tests.support.scenario import Scenario

from passo.errors import CardError


def test_without_a_card_every_command_reports_it():
    with Scenario("i3") as s:
        for command in ("M20", "M21", "M23 x.g", "M30 x.g"):
            assert "there is no card" in s.host.ok(command)[0 if command != "M20" else -2]
        assert "no file is selected" in s.host.ok("M24")[0]


def pull_card(monkeypatch):
    def pulled(*_):
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    monkeypatch.setattr(os, "preadv", pulled)


def test_a_card_that_is_pulled_stops_the_print(s, folder, monkeypatch):
    (folder / "long.g").write_text("G28 X\n" + "".join(f"G1 X{i % 200}\n" for i in range(20000)))
    s.host.ok("M32 long.g")
    s.passes(5)
    pull_card(monkeypatch)
    s.host.expect("Print of long.g stopped: long.g:[0-9]+: was removed while in use", 400)
    s.passes(60)
    at = s.positions()
    s.passes(1)
    assert s.positions() == at


@pytest.mark.parametrize("back", ["the same", "none yet", "another"])
def test_a_card_that_is_back_lets_its_print_continue(s, folder, monkeypatch, back):
    ways = "".join(f"G1 X{i % 200}\n" for i in range(20000))
    text = f"G28 X\nM117 begins\n{ways}G1 X77\n"
    (folder / "long.g").write_text(text)
    s.host.ok("M32 long.g")
    s.passes(5)
    pull_card(monkeypatch)
    s.host.expect("Print of long.g stopped", 400)
    monkeypatch.undo()
    if back == "another":
        (folder / "long.g").write_text(text + "G1 X0\n")
        over = "echo:long.g was changed on the card or removed; its print is cancelled"
        assert s.host.ok("M21") == [over, "SD card ok", "ok"]
        assert "no file is selected" in s.host.ok("M24")[0]
        return
    if back == "none yet":
        away = folder.rename(folder.with_name("away"))
        assert "there is no card" in s.host.ok("M21")[0]
        assert s.host.ok("M24") == ["ok"]
        s.host.expect("Print of long.g stopped: long.g:[0-9]+: was removed", 10)
        away.rename(folder)
    assert s.host.ok("M21") == ["SD card ok", "ok"]
    assert s.host.ok("M24") == ["ok"]
    s.host.expect("Done printing", 20000)
    assert s.positions()["x"] == 77.0
    assert len([line for line in s.host.heard if "begins" in line]) == 1


def test_a_card_that_was_released_is_left_alone(s):
    s.host.ok("M22")
    for line in ("M20", "M23 square.gcode", "M36 square.gcode", "M28 new.g"):
        assert "there is no card: M22 has released it (M21 mounts it)" in s.host.ok(line)[0]
    assert s.host.ok("M29") == ["ok"]
    assert s.host.ok("M21")[0] == "SD card ok"
    assert s.host.ok("M20")[0] == "Begin file list"


class Pulled:
    """A file on a card that fails."""

    size = 100

    def read(self, size, /):
        raise CardError.of("card.removed", "/square.gcode", value="by the test")

    def seek(self, offset, /):
        return offset

    def tell(self):
        return 0

    def close(self):
        pass


@pytest.mark.parametrize("state", [True, False])
def test_a_card_that_fails_at_the_start_ends_the_print_at_once(folder, tmp_path, state):
    places = {"state": str(tmp_path / "state")} if state else {}
    with Scenario("i3", card=str(folder), **places) as s:
        s.host.ok("M23 square.gcode")
        runner = s.printer.state.stop_listeners[0].__self__
        runner.file.reader.close()
        runner.file.reader = Pulled()
        s.host.ok("M24")
        s.host.expect("Print of square.gcode stopped: .*removed while in use", 5)
        assert s.host.ok("M27")[0] == "Not SD printing"
        assert s.host.ok("M23 square.gcode")[1] == "File selected"
        s.host.ok("M24")
        printed(s)
        assert s.positions()["x"] == 60.0
