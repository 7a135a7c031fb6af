"""Files on the card as hosts see them: list, upload, print, pause, cancel."""

import errno
import json
import os
import re

import pytest
from tests.support.card_images import run
from tests.support.scenario import Host, Scenario

from passo.errors import CardError

SQUARE = "M302 P1\nG28\nG1 Z0.2 F600\n" + "".join(
    f"G1 X{10 + 50 * (i % 2)} Y{10 + 50 * (i // 2 % 2)} E{i / 10} F6000\n" for i in range(60)
)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "square.gcode").write_text(SQUARE)
    (tmp_path / "notes.txt").write_text("nothing to print")
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "A long name.gcode").write_text("G28 X\nM117 hello\nG1 X5\n")
    return tmp_path


@pytest.fixture
def s(folder):
    with Scenario("i3", card=str(folder)) as scenario:
        yield scenario


def steps(s):
    return {x.name: s.board.net_steps(x.name) for x in s.board.board.steppers}


def printed(s, within=200):
    s.host.expect("^Done printing file$", within)


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
    missing = f"/{name}: is not on the card. List the card and name what is there."
    assert ok(f"M23 {name}")[0] == f"echo:file.open failed, File: {name}. {missing}"


def test_a_name_with_accents_apart_is_found_by_the_composed_one(s, folder):
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


@pytest.mark.parametrize("end", [b"\0" * 512, b"\r\n\x1a", b"\n\x1arubbish\xff\0\n\x80of a block"])
def test_a_file_that_was_cut_or_is_of_dos_is_printed_to_its_end(s, folder, end):
    (folder / "dos.g").write_bytes(b"\xef\xbb\xbfG28 X\r\nM221 S\r\nG1 X12 F6000" + end)
    s.host.ok("M32 dos.g")
    printed(s)
    assert s.positions()["x"] == 12.0


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (b"G28 X\nG1 X12,5\n", ":2: 'X12,5' has a decimal comma. Write a point: X12.5"),
        (b"G28 X\nM104 S20,5\n", "'S20,5' has a decimal comma. Write a point: S20.5"),
        ("G28 X\n\xa0G1 X5\n".encode(), ":2: the no-break space (U+00A0) in"),
        ("G28 X\n".encode("utf-16"), ":1: the text is UTF-16, not UTF-8"),
        (b"G28 X\n#1=5\n", ":2: '#1=5' is a parameter"),
    ],
)
def test_a_file_with_what_is_not_g_code_stops_and_names_it(s, folder, data, sentence):
    (folder / "bad.g").write_bytes(data)
    s.host.ok("M32 bad.g")
    assert s.until(lambda: any(sentence in line for line in s.host.heard), 60)


def test_aprinter_lists_one_directory(s):
    assert s.host.ok("M20 D/parts") == ["f A long name.gcode", "ok"]
    assert s.host.ok("M20 D") == ["f notes.txt", "d parts", "f square.gcode", "ok"]


def test_a_file_is_printed_to_its_end(s):
    assert s.host.ok("M23 square.gcode") == [
        f"File opened: square.gcode Size: {len(SQUARE)}",
        "File selected",
        "ok",
    ]
    s.host.ok("M24")
    assert re.fullmatch(r"SD printing byte \d+/\d+", s.host.ok("M27")[0])
    printed(s)
    assert s.positions() == {"x": 60.0, "y": 60.0, "z": 0.2, "e": pytest.approx(5.9, abs=0.01)}
    assert s.host.ok("M27")[0] == "Not SD printing"


def test_a_printed_file_stays_selected_and_can_be_rewound(s):
    s.host.ok("M32 square.gcode")
    printed(s)
    done = s.host.heard.count("Done printing file")
    assert s.host.ok("M24")[0] == (
        "echo:square.gcode has been printed to its end. Rewind it with M26 S0, then send M24."
    )
    s.passes(1)
    assert s.host.heard.count("Done printing file") == done
    assert "Not SD printing" in s.host.ok("M27")[0]
    s.host.ok("M26")
    s.host.ok("M24")
    s.passes(3)
    assert "SD printing byte" in s.host.ok("M27")[0]
    printed(s)


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


def test_a_pause_brakes_parks_and_goes_on_from_the_very_point(folder):
    with Scenario("i3", card=str(folder)) as s:
        s.host.ok("M32 square.gcode")
        printed(s)
        undisturbed = steps(s)
    with Scenario("i3", card=str(folder)) as s:
        s.host.ok("M32 square.gcode")
        assert s.until(lambda: s.positions()["e"] > 2, 60)
        before = s.loop.time()
        s.host.ok("M25")
        assert s.until(lambda: s.printer.queue.standing, 2)
        assert s.loop.time() - before <= 0.25
        stopped = s.positions()
        s.passes(4)
        assert s.positions() == stopped | {"z": 10.2, "e": pytest.approx(stopped["e"] - 2, 0.01)}
        s.host.ok("G91")
        s.host.ok("G1 X30 E4 F3000")
        s.host.ok("T0")
        s.host.ok("M400")
        assert s.positions()["x"] == pytest.approx(stopped["x"] + 30, abs=0.02)
        s.host.ok("M24")
        printed(s)
        # What was extruded by hand is extruded; all else is as if there had been no pause.
        assert steps(s) == undisturbed | {"e": undisturbed["e"] + round(4 * 95.5)}


def test_cancelling_leaves_the_heaters_off_and_the_file_selected(s):
    s.host.ok("M106 S255")
    s.host.ok("M140 S60")
    s.host.ok("M32 square.gcode")
    assert s.until(lambda: s.positions()["e"] > 2, 60)
    s.host.ok("M524")
    s.passes(1)
    stopped = s.positions()
    s.passes(5)
    assert s.positions() == stopped
    assert s.printer.connection.heaters["bed"].target == 0
    assert s.board.output_value("part") == 0
    assert s.host.ok("M27")[0] == "Not SD printing"
    s.host.ok("M24")
    printed(s)
    assert s.positions()["x"] == 60.0


def test_a_host_cancels_with_pause_and_rewind(s):
    s.host.ok("M32 square.gcode")
    assert s.until(lambda: s.positions()["e"] > 2, 60)
    s.host.ok("M25")
    s.passes(3)
    s.host.ok("M26 S0")
    assert s.host.ok("M27")[0] == "Not SD printing"
    assert s.host.ok("G1 X1 F6000") == ["ok"]


def test_file_stops_at_failed_command_and_continues_after_it(s, folder):
    (folder / "wrong.g").write_text("G28\nG1 X5 F6000\nG1 X900\nG1 X9\nM104 S200\n")
    s.host.ok("M32 wrong.g")
    s.host.expect("Print of wrong.g stopped: wrong.g:3: .*X.*900", 30)
    s.passes(1)
    assert s.positions()["x"] == 5.0
    s.host.ok("M24")
    printed(s)
    assert s.positions()["x"] == 9.0


def test_a_program_ends_with_m30_and_deletes_nothing(s, folder):
    (folder / "cnc.nc").write_text("%\nG28\nG1 X5 F6000\nM30\nG1 X9\n%\n")
    s.host.ok("M32 cnc.nc")
    printed(s)
    assert s.positions()["x"] == 5.0
    assert (folder / "cnc.nc").exists()


def test_moves_of_a_console_come_between_those_of_a_file(s):
    s.host.ok("M32 square.gcode")
    s.passes(8)
    assert s.host.ok("M106 S100", 10) == ["ok"]
    assert "T:" in s.host.ok("M105")[0]
    printed(s)
    assert s.board.output_value("part") > 0


def test_an_upload_is_there_after_m29(s, folder):
    assert s.host.ok("M28 new.gcode") == ["Writing to file: new.gcode", "ok"]
    s.host.ok("G28")
    s.host.ok("G1 X10 ; a comment")
    assert not (folder / "new.gcode").exists()
    assert s.positions()["x"] == 20.0  # nothing was carried out
    assert s.host.ok("M29") == ["Done saving file.", "ok"]
    assert (folder / "new.gcode").read_text() == "G28\nG1 X10\n"
    assert s.host.ok("M30 new.gcode") == ["File deleted:new.gcode", "ok"]
    assert not (folder / "new.gcode").exists()


def numbered(*lines):
    out = []
    for number, text in lines:
        line = f"N{number} {text}"
        checksum = 0
        for char in line:
            checksum ^= ord(char)
        out.append(f"{line}*{checksum}")
    return out


def test_numbered_upload_drops_numbers_and_answers_queries(s, folder):
    lines = numbered((-1, "M110 N-1"), (0, "G28"), (1, "G1 X10"), (2, "M110 N2"), (3, "G1 X20"))
    s.host.ok("M28 n.gcode")
    for line in lines[:3]:
        s.host.ok(line)
    assert "T:" in s.host.ok("M105")[0]
    assert "not carried out while a file is written" in s.host.ok("G1 X5")[0]
    s.host.send(numbered((7, "G1 X99"))[0])
    s.host.expect("Resend: 2", 1)
    s.host.expect("^ok", 1)
    for line in lines[3:]:
        s.host.ok(line)
    assert s.host.ok("M29")[0] == "Done saving file."
    assert (folder / "n.gcode").read_text() == "G28\nG1 X10\nG1 X20\n"


def test_a_file_that_cannot_be_opened_executes_nothing(s):
    assert "echo:" in s.host.ok("M28 no/such/place.g")[0]
    s.host.ok("G28")
    s.host.ok("G1 X99")
    assert s.host.ok("M29") == ["ok"]
    s.passes(3)
    assert s.positions()["x"] == 20.0


def test_aprinter_s_upload_wrapper(s, folder):
    (folder / "old.g").write_text("G1 X1\n")
    s.host.ok("M932")
    assert s.host.ok("M28 Fold.g")[0] == "Writing to file: old.g"
    s.host.ok("G1 X2")
    s.host.ok("M29")
    s.host.ok("M933")
    assert (folder / "old.g").read_text() == "G1 X2\n"


def test_a_cut_upload_leaves_the_old_file(s, folder):
    s.host.ok("M28 square.gcode")
    s.host.send("G1 X1", "G1 X")
    s.host.session.close()
    assert (folder / "square.gcode").read_text() == SQUARE
    assert sorted(p.name for p in folder.iterdir()) == ["notes.txt", "parts", "square.gcode"]


def test_a_log_is_carried_out_as_well(s, folder):
    s.host.ok("M928 log.g")
    s.host.ok("G92 X0")
    s.host.ok("G1 X7 F6000")
    s.host.ok("M29")
    s.host.ok("M400")
    assert s.positions()["x"] == 27.0
    assert (folder / "log.g").read_text() == "G92 X0\nG1 X7 F6000\n"


def test_reports_by_themselves(s):
    s.host.ok("M27 S1")
    s.host.expect("^Not SD printing", 2)
    s.host.ok("M32 square.gcode")
    s.host.expect("^SD printing byte", 2)
    s.host.ok("M27 S0")
    s.host.silent(3, "^SD printing")
    assert s.host.ok("M27 C")[0] == "Current file: square.gcode"


def test_auto0_is_started(folder):
    (folder / "AUTO0.G").write_text("G28 X\nG1 X33 F6000\n")
    with Scenario("i3", card=str(folder)) as s:
        printed(s, 30)
        assert s.positions()["x"] == 33.0


def test_a_fault_of_the_program_leaves_nothing_hot(folder, monkeypatch):
    def broken(*_):
        raise RuntimeError("by the test")

    with Scenario("i3", card=str(folder)) as s:
        s.host.ok("M140 S60")
        s.passes(1)
        monkeypatch.setattr(s.printer.dispatch, "run_command", broken)
        s.host.ok("M32 square.gcode")
        s.host.expect("Error:Printer halted: a fault of the program, RuntimeError: by the test", 5)
        s.passes(4)
        assert s.board.output_value("bed") == 0
        assert s.printer.connection.heaters["bed"].target == 0


def test_without_a_card_every_command_says_so():
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
def test_a_card_that_is_back_lets_its_print_go_on(s, folder, monkeypatch, back):
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


def test_a_host_that_connects_leaves_a_print_that_failed(s, folder):
    (folder / "half.g").write_text("G28 X\nG1 X10\nG1 E10001\nG1 X20\n")
    s.host.ok("M32 half.g")
    s.host.expect("Print of half.g stopped", 60)
    s.host.ok("M21")
    assert s.host.ok("M24") == ["ok"]
    printed(s, 60)
    assert s.positions()["x"] == 20.0


def test_progress_is_by_time_not_by_bytes(s, folder):
    # The second half of the bytes takes a tenth of the time.
    slow = "".join(f"G1 X{10 + i % 2 * 100} F1000\n" for i in range(1, 31))
    fast = "".join(f"G1 X{10 + i % 2 * 100} F9999\n" for i in range(1, 31))
    (folder / "two.g").write_text("G28 X\nG1 X10 F6000\n" + slow + fast)
    s.host.ok("M32 two.g")
    start = s.loop.time()
    s.passes(60)
    shown = float(re.search(r"([\d.]+)%", s.host.ok("M73")[0])[1])
    printed(s, 300)
    whole = s.loop.time() - start
    assert shown == pytest.approx(100 * 55 / whole, abs=5)
    assert s.host.ok("M73")[0] == "echo:Progress: nothing is printed"


def test_progress_counts_on_behind_a_line_that_failed(s, folder):
    way = "".join(f"G1 X{10 + i % 2 * 50} F600\n" for i in range(20))
    (folder / "half.g").write_text(f"G28 X\n{way}G1 E10001\n{way}")
    s.host.ok("M32 half.g")
    s.host.expect("Print of half.g stopped", 200)
    s.until(lambda: s.printer.queue.standing, 10)
    s.host.ok("M24")
    s.passes(0.1)
    assert float(re.search(r"([\d.]+)%", s.host.ok("M73")[0])[1]) == pytest.approx(50, abs=5)


def test_a_card_that_was_released_is_left_alone(s):
    s.host.ok("M22")
    for line in ("M20", "M23 square.gcode", "M36 square.gcode", "M28 new.g"):
        assert "there is no card: M22 has released it (M21 mounts it)" in s.host.ok(line)[0]
    assert s.host.ok("M29") == ["ok"]
    assert s.host.ok("M21")[0] == "SD card ok"
    assert s.host.ok("M20")[0] == "Begin file list"


@pytest.mark.parametrize("name", ["frog.gco", "Frog.gco", "F"])
def test_a_file_that_is_not_there_is_named_as_it_was_asked_for(s, name):
    assert s.host.ok(f"M23 {name}")[0].startswith(
        f"echo:file.open failed, File: {name}. /{name}: is not"
    )


def test_progress_from_mid_file_counts_bytes_before(s, folder):
    way = "".join(f"G1 X{10 + i % 2 * 50} F600\n" for i in range(40))
    (folder / "a.g").write_text(f"G28 X\n{way}")
    s.host.ok("G28 X", 100)
    s.host.ok("M23 a.g")
    s.host.ok(f"M26 S{len('G28 X ') + len(way) // 4 * 3}")
    s.host.ok("M24")
    for seconds, percent in ((0.5, 75), (25, 87.5)):
        s.passes(seconds)
        assert float(re.search(r"([\d.]+)%, ", s.host.ok("M73")[0])[1]) == pytest.approx(
            percent, abs=1.5
        )
        at = json.loads(s.host.ok("M408 S3")[0])["fractionPrinted"]
        assert at == pytest.approx(percent, abs=1.5)


def test_a_file_takes_back_the_speed_that_it_has_kept(s, folder):
    (folder / "a.g").write_text("G92 X0 Y0 Z0\nM220 B\nM220 S50\nG1 X5 F600\nM220 R\nG1 X0 F600\n")
    s.host.ok("M220 S150")
    s.host.ok("M32 a.g")
    s.passes(0.6)
    assert json.loads(s.host.ok("M408 S0")[0])["params"]["speedFactor"] == 150  # as planned by now
    s.host.expect("Done printing", 10)
    assert s.host.ok("M220") == ["Speed factor override: 150", "ok"]


def test_progress_of_slicer_counts_before_bytes(s, folder):
    (folder / "a.g").write_text("G92 X0 Y0 Z0\n" + "G1 X100 F600\nG1 X0\n" * 9 + "G2 X10\n")
    s.host.ok("M32 a.g")
    s.passes(2)
    assert "% of the file" in s.host.ok("M73")[0]
    s.host.ok("M73 P10 R7")
    assert s.host.ok("M73")[0] == "echo:Progress: 10%, 7 min left"
    assert json.loads(s.host.ok("M408 S3")[0])["fractionPrinted"] == 10
    s.host.ok("M524")
    assert s.host.ok("M73")[0] == "echo:Progress: nothing is printed"
    assert json.loads(s.host.ok("M408 S3")[0])["fractionPrinted"] == 0
    s.host.ok("M26 S13")  # of the next print, too, nothing is known yet
    s.host.ok("M24")
    s.passes(1)
    assert "% of the file" in s.host.ok("M73")[0]


def test_a_question_for_the_file_leaves_the_file_to_the_print(s, folder):
    (folder / "say.g").write_text("G28\n" + "G1 X30 F6000\nM114\nG1 X60\n" * 200)
    other = Host(s)
    s.host.ok("M32 say.g")
    s.passes(5)
    for question in ("M27", "M73", "M408 S3"):
        s.host.heard.clear()
        other.heard.clear()
        s.host.send(f"G4 P1 {question} M118 MARK")
        s.passes(5)
        assert s.host.heard.count("MARK") == other.heard.count("MARK") == 1
        # What the file's commands answer is told to all.
        said = [line for line in other.heard if line.startswith("X:")]
        assert len(said) > 3
        assert [line for line in s.host.heard if line.startswith("X:")] == said


def test_pause_in_mid_line_drops_rest_of_line(folder):
    lines = "G28\n" + "".join(f"G1 X{10 + 50 * (i % 2)} F3000\n" for i in range(20))
    (folder / "line.g").write_text(lines)
    undisturbed = None
    for pause in ("", "M25", "G4 P1 M25 M118 MARK"):
        with Scenario("i3", card=str(folder)) as s:
            s.host.ok("M32 line.g")
            s.passes(8)
            if pause:
                s.host.send(pause)
                s.passes(8)
                s.host.ok("M24")
            printed(s)
            undisturbed = undisturbed or steps(s)
            assert steps(s) == undisturbed
            assert s.positions()["x"] == 60.0
            assert "MARK" not in s.host.heard


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
        runner._reader.close()
        runner._reader = Pulled()
        s.host.ok("M24")
        s.host.expect("Print of square.gcode stopped: .*removed while in use", 5)
        assert s.host.ok("M27")[0] == "Not SD printing"
        assert s.host.ok("M23 square.gcode")[1] == "File selected"
        s.host.ok("M24")
        printed(s)
        assert s.positions()["x"] == 60.0


def test_selection_after_cancel_does_not_start(s, folder):
    (folder / "hot.g").write_text("M109 S200\n")
    (folder / "b.g").write_text("M118 B\nG4 S5\n")
    for last in ("M23 b.g", "M22", "M25"):
        s.host.ok("M32 hot.g")
        s.passes(3)
        s.host.send("M524", "M24", last)
        s.passes(3)
        assert s.host.ok("M27")[0] == "Not SD printing"
        s.host.ok("M21")
    s.host.ok("M32 hot.g")
    s.passes(3)
    s.host.send("M524", "M24")
    s.passes(3)
    assert "SD printing byte" in s.host.ok("M27")[0]
    assert s.printer.connection.heaters["hotend"].target == 200


def test_the_selected_file_is_told_wherever_it_is(s):
    assert s.host.ok("M36")[0].startswith("echo:no file is selected")
    s.host.ok("M23 parts/A long name.gcode")
    told = s.host.ok("M36")[0]
    assert re.fullmatch(r"File: A long name.gcode Short: \S+ Size: 23 Modified: 20\S+ \S+", told)
    assert s.host.ok("M36 square.gcode")[0].startswith("File: square.gcode Short: SQ")


def test_an_upload_has_the_name_that_was_given(s, folder):
    (folder / "ish.gcode").write_text("G4\n")
    for name, path in (
        ("Fish.gcode", "Fish.gcode"),
        ("fish2.gcode", "fish2.gcode"),
        ("F/top.g", "top.g"),
        ("/abs.g", "abs.g"),
        ("F/parts/in.g", "parts/in.g"),
        ("Fparts/in2.g", "parts/in2.g"),
    ):
        s.host.ok(f"M28 {name}")
        s.host.ok("G1 X1")
        assert s.host.ok("M29")[0] == "Done saving file.", name
        assert (folder / path).read_text() == "G1 X1\n"
    assert (folder / "ish.gcode").read_text() == "G4\n"


@pytest.mark.parametrize("strict", [True, False])
def test_upload_to_absolute_path_ignores_directory(s, folder, strict):
    s.host.ok("M932" if strict else "M933")
    s.host.ok("M23 Dparts")
    names = ("F/top.g", "Fhere.g") if strict else ("/top.g", "here.g")
    for name, path in zip(names, ("top.g", "parts/here.g"), strict=True):
        s.host.ok(f"M28 {name}")
        s.host.ok("G1 X3")
        assert s.host.ok("M29")[0] == "Done saving file."
        assert (folder / path).read_text() == "G1 X3\n"


def test_no_other_file_than_the_named_one_is_deleted(s, folder):
    (folder / "ish.gcode").write_text("G4\n")
    assert "is not on the card" in s.host.ok("M30 Fish.gcode")[0]
    assert (folder / "ish.gcode").exists()
    s.host.ok("M30 ish.gcode")
    assert not (folder / "ish.gcode").exists()


@pytest.mark.parametrize("line", ["M106 P", "M104 Sabc", "G1 X", "M207 S"])
def test_a_word_without_a_number_stops_a_print_at_its_line(s, folder, line):
    (folder / "a.g").write_text(f"G92 X20 Y20 Z20\nG1 X30 F3000\n{line}\nG1 X40\n")
    s.host.ok("M32 a.g")
    word = line.split()[1][0]
    s.host.expect(f"^echo:Print of a.g stopped: a.g:3: the word '{word}' has no valid number", 5)
    s.passes(2)
    assert s.positions()["x"] == pytest.approx(30.0, abs=0.01)


def test_a_failed_print_says_once_what_to_do(s, folder):
    (folder / "a.g").write_text("M140 S50\nM106 S255\nM23 nothere.g\nG4 P9\n")
    s.host.ok("M32 a.g")
    assert s.host.expect("stopped", 5) == (
        "echo:Print of a.g stopped: a.g:3: file.open failed, File: nothere.g. /nothere.g: is not"
        " on the card. List the card and name what is there. Correct it and continue after it"
        " (M24), or cancel (M524)."
    )
    s.passes(1)
    bed = s.printer.connection.heaters["bed"]
    assert (bed.target, s.board.output_value("part")) == (50, 1600000)
    s.host.ok("M524")
    s.passes(1)
    assert (bed.target, s.board.output_value("part")) == (0, 0)
    s.host.ok("M24")
    s.host.expect("stopped", 5)  # from its beginning
    s.passes(1)
    assert bed.target == 50
    s.host.ok("M24")
    printed(s)
    s.host.ok("M524")
    assert bed.target == 50  # nothing was left to cancel


def test_a_print_that_asks_for_statistics_goes_on_without_them(s, folder):
    (folder / "a.g").write_text("M78\nG28\nG1 X5\n")
    s.host.ok("M32 a.g")
    s.host.expect("echo:there is no place to store settings", 5)
    printed(s)
    assert s.positions()["x"] == 5.0


def test_m29_may_name_the_file_as_printrun_does(tmp_path):
    with Scenario("i3", card=str(tmp_path)) as s:
        for line in ("M28 gear.g", "G1 X1"):
            s.host.ok(line)
        assert "Done saving file." in s.host.ok("M29 gear.g")
        assert (tmp_path / "gear.g").read_text() == "G1 X1\n"
