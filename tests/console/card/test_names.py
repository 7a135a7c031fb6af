"""The list of the card, and names in every spelling."""

import re

import pytest
from tests.support.card_images import run
from tests.support.card_print import printed
from tests.support.scenario import Scenario


def test_the_list_shows_what_can_be_printed(s):
    answer = s.host.ok("M20")
    assert answer[0] == "Begin file list"
    assert answer[-2:] == ["End file list", "ok"]
    assert len(answer) == 5  # two files
    assert re.fullmatch(r"[A-Z0-9~]{1,8}\.GCO 1\d\d\d", answer[1])
    assert re.fullmatch(r"PARTS/[A-Z0-9~]{1,8}\.GCO 23", answer[2])
    long = s.host.ok("M20 L T")
    assert re.fullmatch(r'PARTS/\S+ 23 0x[0-9A-F]{8} "A long name.gcode"', long[2])


NAMES = [
    "Würfel & Kügel 20mm_0.2mm_PLA.gcode",
    "日本語.gcode",
    "中国語.gcode",
    "🖨 emoji.gcode",
    "Turm 190-220°C, 5 µm².gcode",
    "PLA 220 °C.gcode",
    "it's #1 (2+3).gcode",
]


@pytest.fixture(params=["folder", "image"])
def named(request, tmp_path):
    """A card with names of all kinds, uploaded as they are."""
    card = tmp_path / "card"
    if request.param == "folder":
        card.mkdir()
    else:
        with card.open("wb") as file:
            file.truncate(34 << 20)
        run("mkfs.fat", "-F", "32", card)
    with Scenario("i3", card=str(card)) as s:
        for name in NAMES:
            assert s.host.ok(f"M28 {name}") == [f"Writing to file: {name}", "ok"]
            s.host.ok("G28 X")
            assert s.host.ok("M29") == ["Done saving file.", "ok"]
        yield s


def test_names_in_utf_8_are_listed(named):
    long = named.host.ok("M20 L")[1:-2]
    listed = [re.fullmatch(r'(\S+) 6 "(.*)"', line).groups() for line in long]
    assert sorted(name for _, name in listed) == sorted(NAMES)
    timed = [line.split(" ", 3) for line in named.host.ok("M20 L T")[1:-2]]
    assert [x[3] for x in timed] == [f'"{name}"' for _, name in listed]
    assert named.host.ok("M20")[1:-2] == [f"{short} 6" for short, _ in listed]
    assert sorted(named.host.ok("M20 D")[:-1]) == sorted(f"f {name}" for name in NAMES)
    short = {short for short, _ in listed}
    assert len(short) == len(listed)  # two names of characters beyond ASCII are not alike
    assert all(re.fullmatch(r"[!-~]{1,8}\.GCO", name) for name in short)


def test_names_in_utf_8_are_selected(named):
    ok = named.host.ok
    for line in ok("M20 L")[1:-2]:
        short, _, name = line.split(" ", 2)
        name = name[1:-1]
        for spelled in (name, f"/{name}", f'"{name}"', short, name.upper(), f"  {name} ; it"):
            assert ok(f"M23 {spelled}")[0] == f"File opened: {name} Size: 6"
        assert ok("M27 C")[0] == f"Current file: {name}"
        assert ok(f"M33 {short}")[0] == f"/{name}"
        assert ok(f"M36 {name}")[0].startswith(f"File: {name} Short: {short} Size: 6 ")
    name = NAMES[0]
    assert ok(f"M32 {name}")[0] == f"File opened: {name} Size: 6"
    printed(named)
    assert ok(f"M30 {name}") == [f"File deleted:{name}", "ok"]
    missing = f"/{name}: is not on the card. List the files (M20), and give one of these names."
    assert ok(f"M23 {name}")[0] == f"echo:file.open failed, File: {name}. {missing}"


def test_decomposed_accents_find_the_composed_name(s, folder):
    apart = "Gro\N{COMBINING DIAERESIS}ße.gcode"
    (folder / apart).write_text("G28 X\n")
    assert s.host.ok("M23 Größe.gcode")[0] == f"File opened: {apart} Size: 6"
    assert s.host.ok(f"M23 {apart}")[0] == f"File opened: {apart} Size: 6"


def test_a_name_in_latin_1_is_found(s, folder):
    (folder / "Würfel.gcode").write_text("G28 X\n")
    s.host.send_bytes("M23 Würfel.gcode\n".encode("latin-1"))
    s.host.expect("^File opened: Würfel.gcode Size: 6$")


def test_a_semicolon_in_quotes_and_a_star_belong_to_a_name(s, folder):
    (folder / "a;b.gcode").write_text("G28 X\n")
    assert s.host.ok('M23 "a;b.gcode" ; this one')[0] == "File opened: a;b.gcode Size: 6"
    assert "File: a. " in s.host.ok("M23 a;b.gcode")[0]
    (folder / "2*3").write_text("G28 X\n")
    assert s.host.ok("M23 2*3")[0] == "File opened: 2*3 Size: 6"


def test_aprinter_lists_one_directory(s):
    assert s.host.ok("M20 D/parts") == ["f A long name.gcode", "ok"]
    assert s.host.ok("M20 D") == ["f notes.txt", "d parts", "f square.gcode", "ok"]


def test_names_are_found_in_every_form(s):
    for name in (
        "square.gcode",
        "SQUARE.GCODE",
        "/square.gcode",
        "Fsquare.gcode",
        "Fsquare\\2Egcode",
        "parts/A long name.gcode",
        "Fparts/A\\20long\\20name.gcode",
    ):
        assert s.host.ok(f"M23 {name}")[1] == "File selected", name
    short = s.host.ok("M20")[2].split()[0]
    assert s.host.ok(f"M33 {short}") == ["/parts/A long name.gcode", "ok"]
    s.host.ok("M23 Dparts")
    assert s.host.ok("M23 A long name.gcode")[1] == "File selected"
    s.host.ok("M23 R")
    assert "file.open failed, File: A long name.gcode" in s.host.ok("M23 A long name.gcode")[0]


def test_escaped_bytes_of_a_name_are_utf_8_where_they_can_be(s, folder):
    for name in ("é.gcode", "ü.gcode"):
        (folder / name).write_text("G92 X0\n")
    assert s.host.ok("M23 F\\C3\\A9.gcode")[1] == "File selected"
    assert s.host.ok("M23 F\\FC.gcode")[1] == "File selected"  # of Latin-1


@pytest.mark.parametrize("name", ["frog.gco", "Frog.gco", "F"])
def test_a_file_that_is_not_there_is_named_as_it_was_asked_for(s, name):
    assert s.host.ok(f"M23 {name}")[0].startswith(
        f"echo:file.open failed, File: {name}. /{name}: is not"
    )


def test_the_selected_file_is_reported_wherever_it_is(s):
    assert s.host.ok("M36")[0].startswith("echo:no file is selected")
    s.host.ok("M23 parts/A long name.gcode")
    told = s.host.ok("M36")[0]
    assert re.fullmatch(r"File: A long name.gcode Short: \S+ Size: 23 Modified: 20\S+ \S+", told)
    assert s.host.ok("M36 square.gcode")[0].startswith("File: square.gcode Short: SQ")


def test_one_name_is_one_file_in_every_command(s, folder):
    (folder / "ish.gcode").write_text("G4\n")
    assert "is not on the card" in s.host.ok("M30 fish.gcode")[0]
    for command in ("M23", "M32", "M36", "M33"):
        assert "ish.gcode" in s.host.ok(f"{command} Fish.gcode")[0], command
    s.host.ok("M524")
    (folder / "Fish.gcode").write_text("G4\n")
    assert s.host.ok("M30 Fish.gcode") == ["File deleted:Fish.gcode", "ok"]
    assert s.host.ok("M30 Fish.gcode") == ["File deleted:ish.gcode", "ok"]
    assert not (folder / "ish.gcode").exists()
