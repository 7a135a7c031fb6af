"""What a console answers, and when; several consoles at one printer."""

import re
from functools import reduce
from operator import xor

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.support.scenario import Host, Scenario

from passo.console.receive_queue import BACKLOG, MAX_LINES


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        yield scenario


@pytest.fixture
def ready(s):
    """All axes know where they are: at 20 mm."""
    s.host.ok("G92 X20 Y20 Z20")
    return s


def oks(host, start=0):
    return [x for x in host.heard[start:] if x.startswith("ok")]


def times_of(s, pattern, seconds):
    """When, from now on, lines with the pattern were heard."""
    times, seen, start = [], len(s.host.heard), s.loop.time()

    def look():
        nonlocal seen
        new = s.host.heard[seen:]
        seen = len(s.host.heard)
        times.extend(round(s.loop.time() - start, 2) for x in new if re.search(pattern, x))
        return False

    s.until(look, seconds)
    return times


# -- one ok a line --------------------------------------------------------------------------------

LINES = [
    "M105",
    "G1 X30 F6000",
    "G1 X9999",
    "G1 Xabc",
    "G0",
    "HELLO WORLD=1",
    "%",
    "T0",
    "T9",
    "T-1",
    "G999",
    "M9999",
    "M117",
    "M118",
    "M23 nothing.g",
    "M28",
    "M29",
    "M104 S1" + "0" * 400,
    "M106 P99 S1",
    "G92 Q5",
    "M26 S1" + "0" * 400,
    "M155 S1" + "0" * 400,
    "M113 S",
    "M110",
    "N4 G28",
    "\xb0\xff",
    "g1 x21",
    "M862.3 P1",
    "*12",
    "(a comment)",
]


@pytest.mark.parametrize("line", LINES)
def test_each_line_is_answered_by_one_ok(ready, line):
    start = len(ready.host.heard)
    ready.host.send_bytes(line.encode("latin-1") + b"\n")
    ready.passes(3)
    assert len(oks(ready.host, start)) == 1, ready.host.heard[start:]
    assert ready.host.ok("M110 N0") == ["ok"]


def test_blank_lines_and_comments_are_not_answered(s):
    start = len(s.host.heard)
    s.host.send("", "   ", "; nothing")
    s.passes(0.5)
    assert s.host.heard[start:] == []


def test_echo_of_a_line_is_harmless_text(s):
    s.host.send_bytes(b"\xff\xfb\x01\x1b[2JM105\nM118 \x07a\n")
    s.host.expect("^[?]a$")
    assert all(line.isprintable() for line in s.host.heard)


def test_texts_are_utf_8_both_ways(s):
    """Units of the printer's own texts are in ASCII; bytes that are not UTF-8 are Latin-1."""
    assert s.host.ok("M117 Grüße 日本 🖨") == ["// action:notification Grüße 日本 🖨", "ok"]
    s.host.send_bytes(b"M118 Gr\xfc\xdfe\n")
    s.host.expect("^Grüße$")
    assert s.host.ok("M104 S999")[0].isascii()
    assert s.host.ok("M104 S٣")[0].startswith("echo:the arabic-indic digit three (U+0663) in 'S٣'")


@pytest.mark.parametrize(
    ("line", "answer"),
    [
        ("G1 X31,5", "'X31,5' has a decimal comma. Write a point: X31.5."),
        ("M104 S200,5", "'S200,5' has a decimal comma. Write a point: S200.5."),
        ("M220 S50,5", "'S50,5' has a decimal comma. Write a point: S50.5."),
        ("G1 X1.2.3", "'X1.2.3' has two decimal points. Write one decimal number."),
        (
            "M104 S200 — hot",
            "the em dash (U+2014) in '—' is not a character of G-code. Write - for",
        ),
        ("\xa0G1 X5", r"the no-break space (U+00A0) in '\xa0G1' is not a character of G-code. Re"),
        ("#1=5", "'#1=5' is a parameter, an expression or a placeholder, which are not evaluat"),
        ("M104 S[temp]", "'S[temp]' is a parameter, an expression or a placeholder, which are not"),
        ("G1 X−5", "the minus sign (U+2212) in 'X−5' is not a character of G-code. Write - for"),
    ],
)
def test_a_character_that_is_not_g_code_is_named(ready, line, answer):
    assert ready.host.ok(line)[0].startswith(f"echo:{answer}")
    assert ready.positions()["x"] == 20.0


def test_print_pauses_at_a_character_that_hides_a_move(ready):
    ready.host.ok("N0 M110 N0*125")
    assert ready.host.ok(numbered(1, "\xa0G1 X5"))[1] == "// action:pause"
    assert ready.host.ok(numbered(2, "G1 X5,5"))[1] == "// action:pause"


def test_piped_file_may_have_byte_order_mark_and_ctrl_z(s):
    s.host.send_bytes(b"\xef\xbb\xbfG92 X20\r\nM118 there\r\n\x1a\r\n")
    s.host.expect("^there$")
    assert s.host.ok("M114")[0].startswith("X:20.000")
    assert not any(line.startswith("echo:the") for line in s.host.heard)


@pytest.mark.parametrize(
    "line",
    [
        *("M221 S", "M221 R", "M221 X0 Y0 Z0", "M220 S", "M302 S", "M73 P R"),
        *("M113 S", "M155 S", "M154 S", "M540 S", "M17 R"),
    ],
)
def test_letter_without_a_number_changes_nothing(s, line):
    before = s.host.ok("M503")
    answer = s.host.ok(line)
    assert not any("no valid number" in text for text in answer)
    assert s.host.ok("M503") == before


def test_unknown_commands_are_named(s):
    assert s.host.ok("M9999") == ['echo:Unknown command: "M9999"', "ok"]
    assert s.host.ok("PRINT_START A=1") == ['echo:Unknown command: "PRINT_START"', "ok"]


WORDS = st.one_of(
    st.sampled_from(["G28 X", "M105", "M114", "M400", "G4 P10", "M109 S0", "T0", "M28 a", "M29"]),
    st.from_regex(r"[GMTN]-?[0-9]{1,4}( ?[A-Z*]-?[0-9.]{0,12}){0,3}", fullmatch=True),
    st.text(st.characters(codec="latin-1"), max_size=12),
)


@settings(max_examples=40)
@given(st.lists(WORDS, max_size=12))
def test_no_line_crashes_a_console(lines):
    with Scenario("i3") as s:
        s.host.ok("M110 N0")
        for line in lines:
            s.host.send_bytes(line.encode("latin-1") + b"\n")
            s.passes(0.1)
            s.host.send("M108", "M110 N0")
            s.passes(0.1)
        s.host.send("M29", "M933", "M999", "M118 still here")
        for _ in range(400):
            s.host.send("M108")
            s.passes(1)
            if "still here" in s.host.heard:
                break
        s.host.expect("^still here$", 0)
        assert all(x.isprintable() or "\xa0" in x or "\xad" in x for x in s.host.heard)


def test_damaged_lines_are_requested_again(s):
    s.host.ok("N0 M110 N0*125")
    assert s.host.ok("N1 M115*38") == [
        "Error:checksum mismatch, Last Line: 0",
        "Resend: 1",
        "ok",
    ]
    assert s.host.ok("N2 M105*37")[1] == "Resend: 1"
    assert s.host.ok("N1 M115*39")[-1] == "ok"
    assert s.host.ok("N1 M115*39") == ["echo:line 1 has come already", "ok"]


def numbered(number, text):
    """A line as hosts send it."""
    line = f"N{number} {text}"
    return f"{line}*{reduce(xor, line.encode())}"


def test_a_long_outline_is_carried_out_and_counted(s):
    outline = ",".join(f"[{100 + i / 10:.3f},{50 + i / 5:.3f}]" for i in range(400))
    command = f"EXCLUDE_OBJECT_DEFINE NAME=ring CENTER=100,100 POLYGON=[{outline}]"
    assert len(command) > 6000
    assert s.host.ok("N0 M110 N0*125") == ["ok"]
    assert not any("Resend" in line for line in s.host.ok(numbered(1, command)))
    assert s.host.ok(numbered(2, "G92 X20")) == ["ok"]
    assert s.host.ok(numbered(3, "M114"))[0].startswith("X:20.000")


def test_too_long_line_is_answered_once(s):
    """It is left out; a print pauses where it is a move."""
    left_out = "is longer than 65536 characters and is left out. Send shorter lines"
    s.host.ok("N0 M110 N0*125")
    assert s.host.ok(numbered(1, "M486 A" + "x" * 70_000)) == [f"echo:line 1 {left_out}", "ok"]
    assert s.host.ok(numbered(2, "M105"))[0].startswith("ok T:")
    assert s.host.ok(numbered(3, "G1 X" + "1" * 70_000)) == [
        f"echo:line 3 {left_out}",
        "// action:pause",
        "ok",
    ]
    assert s.host.ok("M486 A" + "x" * 70_000) == [f"echo:this line {left_out}", "ok"]


def test_line_numbers_of_more_than_thirty_bits(s):
    assert s.host.ok("M110 N2147483646") == ["ok"]
    assert s.host.ok(numbered(2147483647, "M115"))[-1] == "ok"
    assert s.host.ok(numbered(9, "M110 N99999999999")) == ["ok"]
    assert s.host.ok(numbered(100000000000, "M110")) == ["ok"]
    assert s.host.ok(numbered(100000000001, "M31"))[-1] == "ok"


def test_star_in_an_object_label_is_not_a_checksum(s):
    for line in ("M486 S0 Aspanner 13*10.stl", "M486 S0 Aspanner 13*10"):
        assert not any("checksum" in heard for heard in s.host.ok(line))
    assert s.host.ok("M117 3*4") == ["// action:notification 3*4", "ok"]


# -- time -----------------------------------------------------------------------------------------


def test_idle_console_prints_wait_every_second(s):
    s.host.ok("M110")
    assert times_of(s, "^wait$", 3.5) == pytest.approx([1, 2, 3], abs=0.02)


def test_busy_console_never_prints_wait(s):
    s.host.send("M109 S200")
    assert times_of(s, "^wait$", 5) == []


@pytest.mark.parametrize(
    ("interval", "expected"), [("", [2, 4]), (" S1", [1, 2, 3, 4]), (" S0", [])]
)
def test_busy_is_sent_at_each_interval_of_m113(ready, interval, expected):
    if interval:
        ready.host.ok("M113" + interval)
    assert ready.host.ok("M113")[0] == f"M113 S{interval[2:] or 2}"
    ready.host.send("G1 X170 F1800", "M400")  # 150 mm at 30 mm/s
    assert times_of(ready, "^echo:busy: processing$", 4.9) == pytest.approx(expected, abs=0.02)
    ready.passes(2)
    assert len(oks(ready.host)) >= 4
    ready.host.silent(5, "busy")


def test_busy_names_its_cause(s):
    s.host.send("M109 S200")
    s.host.expect("^echo:busy: heating$", 3)
    s.host.send("M108")
    s.host.expect("^ok", 1)
    s.host.silent(5, "busy")


def test_temperatures_are_reported_at_the_interval_of_m155(s):
    s.host.ok("M155 S2")
    assert times_of(s, r"^ T:\d+\.\d\d /0\.00 B:", 7) == pytest.approx([2, 4, 6], abs=0.02)
    s.host.ok("M155 S0")
    s.host.silent(5, "T:")


def test_reports_come_while_a_command_waits(s):
    s.host.ok("M155 S1")
    s.host.send("M109 S200")
    assert len(times_of(s, r"^ T:", 4.5)) == 4


def test_the_position_is_reported_at_the_interval_of_m154(s):
    other = Host(s)
    s.host.ok("M154 S1")
    assert times_of(s, r"^X:0\.000 Y:0\.000 Z:0\.000 E:0\.0000 Count X:", 3.5) == (
        pytest.approx([1, 2, 3], abs=0.02)
    )
    assert not [x for x in other.heard if "Count" in x]  # each console has its own
    s.host.ok("M154 S0")
    s.host.silent(3, "Count")


# -- capabilities ---------------------------------------------------------------------------------


def capabilities(host):
    lines = host.ok("M115")
    assert re.match(r"FIRMWARE_NAME:Passo \S+ PROTOCOL_VERSION:1\.0 MACHINE_TYPE:\S", lines[0])
    assert lines[-1] == "ok"
    found = dict(re.fullmatch(r"Cap:([A-Z_0-9]+):([01])", x).groups() for x in lines[1:-1])
    return {name for name, there in found.items() if there == "1"}


def test_every_capability_is_true(tmp_path):
    (tmp_path / "A name of some length.gcode").write_text("G4 S1\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        shown = {
            "AUTOREPORT_TEMP": lambda: s.host.ok("M155 S1") and s.host.expect("^ T:", 1.1),
            "AUTOREPORT_POS": lambda: s.host.ok("M154 S1") and s.host.expect("^X:", 1.1),
            "AUTOREPORT_SD_STATUS": lambda: s.host.ok("M27 S1") and s.host.expect("SD print", 1.1),
            "BUSY_PROTOCOL": lambda: s.host.send("M109 S90") and s.host.expect("busy: heat", 2.1),
            "EMERGENCY_PARSER": lambda: s.host.send("M108") and s.host.expect("^ok", 0.1),
            "PROMPT_SUPPORT": lambda: (
                s.host.send("M0 Look")
                and s.host.expect("^// action:prompt_begin Look", 0.5)
                and s.host.send("M876 S0")
                and s.host.expect("^ok", 0.5)
            ),
            "PROGRESS": lambda: s.host.ok("M532 X40") and "40%" in s.host.ok("M73")[0],
            "EXTENDED_M20": lambda: '"A name of some length.gcode"' in "".join(s.host.ok("M20 L")),
            "LFN_WRITE": lambda: (
                s.host.ok("M28 Another long name.gcode")
                and s.host.ok("M29")
                and (tmp_path / "Another long name.gcode").exists()
            ),
        }
        assert capabilities(s.host) == set(shown)
        for name, show in shown.items():
            assert show(), name


def test_capabilities_without_a_card_do_not_name_it(s):
    assert capabilities(s.host) == {
        "AUTOREPORT_TEMP",
        "AUTOREPORT_POS",
        "BUSY_PROTOCOL",
        "EMERGENCY_PARSER",
        "PROMPT_SUPPORT",
        "PROGRESS",
    }


# -- small commands -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("command", "heard"),
    [
        ("M118 hello ; all", "hello ; all"),
        ("M118 E1 hello", "echo:hello"),
        ("M118 A1 action:pause", "// action:pause"),
        ("M118 E1 A1 both", "echo:// both"),
        ("M118 P0 A1 action:cancel", "// action:cancel"),
        ("M118 A0 E0 plain", "plain"),
        ("M118 //action:pause", "//action:pause"),
        ("M118 A1", "// "),
    ],
)
def test_m118_speaks_to_all_consoles(s, command, heard):
    other = Host(s)
    assert s.host.ok(command) == [heard, "ok"]
    assert other.heard == [heard]


def test_advanced_ok_reports_number_and_room(ready):
    ready.host.session.advanced_ok = True
    assert ready.host.ok("N0 M110 N0*125") == [f"ok N0 P2048 B{BACKLOG}"]
    assert ready.host.ok("M110 N0") == [f"ok P2048 B{BACKLOG}"]
    assert ready.host.ok("M105")[0].startswith(f"ok P2048 B{BACKLOG} T:2")
    assert ready.host.ok("G1 X30 F600")[0] == f"ok P2047 B{BACKLOG}"
    assert ready.host.ok("N1 M115*38")[-1] == f"ok P2047 B{BACKLOG}"


def test_a_strict_console_refuses_all_after_a_failure(ready):
    ready.host.ok("M932")
    assert ready.host.ok("G1 X21 F6000") == ["ok"]
    assert ready.host.ok("M23 nothing.g")[0].startswith("Error:file.open failed")
    for command in ("G1 X22", "M105", "M115"):
        assert ready.host.ok(command) == ["Error:PreviousCommandFailed", "ok"]
    other = Host(ready)
    assert "T:" in other.ok("M105")[0]  # each console for itself
    assert ready.host.ok("M932") == ["ok"]
    assert "T:" in ready.host.ok("M105")[0]
    ready.host.ok("M23 nothing.g")
    assert ready.host.ok("M933") == ["ok"]
    assert ready.host.ok("G1 X23") == ["ok"]


# -- order ----------------------------------------------------------------------------------------


def test_received_lines_run_in_order(ready):
    start = len(ready.host.heard)
    ready.host.send("G4 S1", "M400", *(f"M118 {i}" for i in range(40)), "M105", "M118 end")
    ready.host.expect("^end$", 3)
    told = [x for x in ready.host.heard[start:] if not x.startswith("ok")]
    assert told == [str(i) for i in range(40)] + ["end"]
    ready.passes(0.1)
    assert len(oks(ready.host, start)) == 44


def test_a_host_that_sends_too_much_is_held_up_and_loses_nothing(ready):
    start = len(ready.host.heard)
    ready.host.send("G4 S1", "M400", *["M110"] * (MAX_LINES + 1))
    assert ready.host.held
    ready.passes(2)
    assert not ready.host.held
    assert len(oks(ready.host, start)) == MAX_LINES + 3


def test_two_consoles_move_the_machine_in_turn(ready):
    other = Host(ready)
    for host, letter in ((ready.host, "X"), (other, "Y")):
        lines = []
        for i in range(20):
            lines += [f"G1 {letter}{30 + i} F6000", "M400", f"M118 {letter}"]
        host.send(*lines)
    ready.until(lambda: len(oks(other)) == 60 and len(oks(ready.host)) >= 60, 60)
    told = [x for x in other.heard if x in ("X", "Y")]
    assert len(told) == 40
    for i in range(0, 40, 2):
        assert set(told[i : i + 2]) == {"X", "Y"}, told
    assert (ready.positions()["x"], ready.positions()["y"]) == (49.0, 49.0)


def test_questions_are_answered_while_another_console_waits(s):
    other = Host(s)
    other.send("M109 S200")
    s.passes(0.5)
    for command in ("M105", "M114", "M115", "M119", "M27"):
        start = s.loop.time()
        s.host.ok(command)
        assert s.loop.time() - start < 0.02, command


# -- ahead of every queue -------------------------------------------------------------------------

BUSY = {
    "heating": ["M109 S250"],
    "dwelling": ["G4 S100", "M400"],
    "moving": ["G1 X200 F120", "M400"],
}


@pytest.mark.parametrize("busy", BUSY)
@pytest.mark.parametrize("own", [True, False])
def test_m112_acts_ahead_of_every_queue(ready, busy, own):
    other = ready.host if own else Host(ready)
    ready.host.send(*BUSY[busy], *["G1 X21 F6000"] * (BACKLOG - 3))
    ready.passes(1)
    at = ready.positions()
    other.send("M112")
    ready.host.expect("Printer halted: emergency stop by M112", 0.1)
    ready.passes(1)
    assert all(h.target == 0 for h in ready.printer.rig.connection.heaters.values())
    assert ready.positions()["x"] == pytest.approx(at["x"], abs=0.1)
    ready.passes(2)
    number = len(BUSY[busy]) + BACKLOG - 3
    assert len(oks(ready.host)) == number + 1 + own  # G92
    assert "M999" in ready.host.ok("G1 X30")[0]
    ready.host.send("M999")
    ready.host.expect("ready again", 3)
    assert ready.host.ok("G28", 60)[-1] == "ok"


@pytest.mark.parametrize("own", [True, False])
def test_m108_ends_a_wait_after_a_full_backlog(ready, own):
    other = ready.host if own else Host(ready)
    ready.host.send("M109 S250", *["M110"] * (BACKLOG - 1))
    ready.passes(1)
    start = len(ready.host.heard)
    other.send("M108")
    ready.passes(0.05)
    assert len(oks(ready.host, start)) == BACKLOG + own
    assert ready.printer.rig.connection.heaters["hotend"].target == 250
    assert ready.host.ok("G1 X25 F6000") == ["ok"]


def test_m108_ends_the_wait_for_moves_and_the_moves_continue(ready):
    ready.host.send("G1 X60 F1200", "M400")
    ready.passes(0.5)
    ready.host.send("M108")
    ready.passes(0.03)
    assert len(oks(ready.host)) == 4  # G92, G1, M400, M108
    assert not ready.printer.rig.queue.standing
    ready.host.ok("G1 X20")
    ready.host.ok("M400")
    assert ready.positions()["x"] == 20.0


def test_m108_before_a_wait_does_not_end_it(s):
    s.host.ok("M108")
    s.host.send("M109 S250")
    s.host.silent(4, "^ok")


@pytest.mark.parametrize("own", [True, False])
def test_m410_stops_the_moves_after_a_full_backlog(ready, own):
    other = ready.host if own else Host(ready)
    ready.host.send("G1 X200 F3000", "M400", *["M110"] * (BACKLOG - 2))
    ready.passes(1)
    other.send("M410")
    ready.until(lambda: ready.printer.rig.queue.standing, 1)
    at = ready.positions()["x"]
    assert 60 < at < 90
    ready.passes(1)
    assert ready.positions()["x"] == at
    assert f"X:{at:.2f}"[:-1] in ready.host.ok("M114")[0]
    ready.host.ok("G1 X20")
    ready.host.ok("M400")
    assert ready.positions()["x"] == pytest.approx(20.0, abs=0.02)


# -- consoles come and go -------------------------------------------------------------------------

GOING = {
    "heating": "M109 S250",
    "homing": "G28",
    "moving": "G1 X200 F600\nM400",
    "in mid-line": "G1 X30 F6000\nG1 X3",
    "dwelling": "G4 S100\nM400",
    "person": "M0",
}


@pytest.mark.parametrize("what", GOING)
def test_closed_console_does_not_block_others(ready, what):
    other = Host(ready)
    other.send_bytes(GOING[what].encode() + b"\n" * (what != "in mid-line"))
    ready.passes(0.5)
    other.session.close()
    heard = len(other.heard)
    ready.passes(0.5)
    if what == "homing":
        at = ready.positions()
        ready.passes(1)
        assert ready.positions() == at
        assert "is not homed" in ready.host.ok("G1 X30")[0]
        assert ready.host.ok("G28", 60)[-1] == "ok"
    ready.host.ok("M410")
    ready.passes(1)
    assert ready.host.ok("G1 X40 F6000", 5) == ["ok"]
    assert ready.host.ok("M400", 20)[-1] == "ok"
    assert ready.positions()["x"] == pytest.approx(40, abs=0.02)
    assert len(other.heard) == heard


def test_console_closed_while_waiting_for_motion_lock(ready):
    other = Host(ready)
    ready.host.send("G1 X60 F1200", "M400")
    other.send("G1 X100", "G1 X150")
    ready.passes(0.1)
    other.session.close()
    ready.host.expect("^ok", 5)
    ready.host.ok("M400")
    assert ready.positions()["x"] == 60.0


def test_after_m999_consoles_continue(ready):
    ready.host.ok("M112")
    ready.host.expect("^Error:Printer halted", 1)
    assert "Printer stopped: emergency stop by M112" in ready.host.ok("G28")[0]
    assert "T:" in ready.host.ok("M105")[0]
    ready.host.send("M999")
    ready.host.expect("^echo:The printer is ready again", 3)
    assert ready.host.ok("G28", 60)[-1] == "ok"
    assert ready.host.ok("M999") == ["ok"]  # nothing to revive


def test_lines_of_a_file_are_not_commands_ahead_of_the_queue(tmp_path):
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.send("M28 a.g", "M112", "M108", "M410", "M29")
        s.host.expect("Done saving file", 1)
        assert not s.printer.state.halted
        assert (tmp_path / "a.g").read_text() == "M112\nM108\nM410\n"
        s.host.ok("M112")
        assert s.printer.state.halted


@pytest.mark.parametrize("command", ["G28", "M109 S250", "G1 X100 F600\nM400", "M303 E0 S200"])
def test_m999_right_after_m112_ends_all_waits(ready, command):
    other = Host(ready)
    other.send(*command.split("\n"))
    ready.passes(0.5)
    ready.host.send("M112", "M999")
    ready.host.expect("ready again", 1)
    ready.passes(0.1)
    assert len(oks(other)) == len(command.split("\n"))
    assert "does not know where" not in "".join(ready.host.ok("G28", 60))
    assert ready.printer.rig.job.locked_axes == []


def test_m108_ends_a_tune_that_has_not_begun(ready):
    ready.host.send("G1 X60 F1200", "M303 E0 S200 C3")
    ready.passes(0.5)
    ready.host.send("M108")
    ready.passes(0.1)
    assert len(oks(ready.host)) == 4  # G92, G1, M303, M108
    assert ready.printer.rig.connection.heaters["hotend"].target == 0
