"""Files of the card that are replaced, rewritten or removed while they are selected or printed."""

import os

import pytest
from tests.support.scenario import Host, Scenario

MOVES = 3000
WAY = "".join(f"G1 X{20 + i % 100} F6000 ; move {i:30}\n" for i in range(MOVES))
PROGRAM = f"G92 X20 Y20\n{WAY}M118 old\n"
OTHER = PROGRAM.replace("F6000", "Y9   ").replace("old", "new")


@pytest.fixture
def s(tmp_path):
    (tmp_path / "way.g").write_text(PROGRAM)
    with Scenario("i3", card=str(tmp_path)) as scenario:
        scenario.card = tmp_path / "way.g"
        yield scenario


def rewritten(path, text):
    """By an editor that writes into the file."""
    with path.open("r+") as file:
        file.write(text)
    os.utime(path, ns=(0, 1))


# -- by the computer that holds the folder --------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda path: rewritten(path, OTHER), "it was written to"),
        (lambda path: os.truncate(path, 20_000), "it has 20000 bytes instead of "),
        (lambda path: path.write_text(PROGRAM + OTHER), "it has [0-9]+ bytes instead of "),
    ],
    ids=["rewritten", "truncated", "longer"],
)
def test_a_file_that_changes_under_its_print_stops_it(s, change, sentence):
    """Nothing of what is new is printed: the print ends with a line of the old file."""
    s.host.ok("M104 S60")
    s.host.ok("M32 way.g")
    s.passes(2)
    change(s.card)
    said = s.host.expect("^echo:Print of way.g stopped: way.g:[0-9]+: was changed", 200)
    assert "on the computer while in use: " in said
    assert s.host.heard.count("Done printing file") == 0
    line = int(said.split("way.g:")[1].split(":")[0])
    assert 100 < line < MOVES
    s.until(lambda: s.printer.rig.queue.standing, 100)
    assert s.positions()["x"] == 20 + (line - 3) % 100
    assert s.printer.rig.connection.heaters["hotend"].target == 0
    s.host.ok("M24")  # what is wrong does not go away
    text = f"stopped: way.g:{line}: was changed on the computer while in use: {sentence}"
    s.host.expect(text, 100)
    s.host.ok("M524")
    assert s.printer.rig.connection.heaters["hotend"].target == 0


def test_changed_file_prints_when_selected_again(s):
    s.host.ok("M23 way.g")
    rewritten(s.card, OTHER)
    s.host.ok("M24")
    s.host.expect("stopped: way.g:1: was changed on the computer .* Select it again", 1)
    s.host.ok("M32 way.g")
    s.host.expect("^new$", 200)
    s.host.expect("^Done printing file$", 10)
    assert s.positions()["y"] == 9


@pytest.mark.parametrize("removed", [True, False])
def test_a_file_that_is_replaced_is_printed_as_it_was(s, removed, tmp_path):
    """Its bytes stay as long as it is open. The next print needs the new one selected."""
    s.host.ok("M32 way.g")
    s.passes(2)
    if removed:
        s.card.unlink()
    else:
        (tmp_path / "other.g").write_text(OTHER)
        (tmp_path / "other.g").replace(s.card)
    s.host.expect("^old$", 200)
    s.host.expect("^Done printing file$", 10)
    assert s.positions()["x"] == 119
    s.host.ok("M26 S0")
    s.host.ok("M24")
    s.host.expect("stopped: way.g:1: was changed .*: it was replaced or removed", 1)
    if not removed:
        s.host.ok("M32 way.g")
        s.host.expect("^new$", 200)


# -- by commands ----------------------------------------------------------------------------------


@pytest.mark.parametrize("paused", [True, False])
@pytest.mark.parametrize("name", ["way.g", "WAY.G", "/way.g"])
def test_printing_file_is_not_overwritten_or_deleted(s, paused, name):
    other = Host(s)
    s.host.ok("M32 way.g")
    s.passes(1)
    if paused:
        s.host.ok("M25")
        s.passes(10)
    assert "way.g is being printed" in other.ok(f"M30 {name}")[0]
    assert "way.g is being printed" in other.ok(f"M28 {name}")[0]
    assert other.ok("G1 X90")[0].startswith("echo:G1 is not carried out")
    other.ok("M29")
    assert s.card.read_text() == PROGRAM
    if paused:
        s.host.ok("M24")
    s.host.expect("^old$", 200)
    s.host.expect("^Done printing file$", 10)
    assert s.positions()["x"] == 119


def test_a_file_that_was_printed_may_be_overwritten_and_deleted(s):
    """It is selected no more then."""
    s.card.write_text("M118 old\n")
    s.host.ok("M32 way.g")
    s.host.expect("^Done printing file$", 10)
    for line in ("M28 WAY.G", "M118 new", "M29"):
        s.host.ok(line)
    assert "no file is selected" in s.host.ok("M24")[0]
    s.host.ok("M32 way.g")
    s.host.expect("^new$", 10)
    s.host.expect("^Done printing file$", 10)
    assert s.host.ok("M30 way.g") == ["File deleted:way.g", "ok"]
    assert not s.card.exists()
