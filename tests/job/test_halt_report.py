"""The report of a halt: what it holds and leaves out, where it is, and what a full disk does."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.board.fault_injection import FaultOrder
from passo.config.machine_text import machine_text
from passo.errors import in_words
from passo.job.live import halt_reports

PART = "G28\n" + "".join(f"G1 X{20 + i % 2 * 60} Y{20 + i} F6000\n" for i in range(100))


@pytest.fixture
def card(tmp_path):
    (tmp_path / "card").mkdir()
    (tmp_path / "card/part.g").write_text(PART)
    return str(tmp_path / "card")


def sections(path):
    """The lines of each section of a report, by its title; those before the first by ''."""
    found, title = {"": []}, ""
    for line in path.read_text(encoding="utf-8").splitlines():
        if heading := re.fullmatch(r"== (.+?)(?:: .*)? ==", line):
            title = heading[1]
            found[title] = []
        elif line:
            found[title].append(line)
    return found


def reports(folder, stem="halt"):
    return sorted(Path(folder).glob(f"{stem}-*.txt"))


def frames(lines):
    """(seconds, sender, clock of the board, message) of each line after the heading."""
    rows = [line.split(maxsplit=3) for line in lines[3:]]
    return [(float(s), sender, int(clock), text) for s, sender, clock, text in rows]


def test_heater_fault_report(tmp_path, card):
    with Scenario(card=card, state=str(tmp_path / "state")) as s:
        s.host.ok("M104 S200")
        s.passes(30)
        s.host.ok("M32 part.g")
        s.passes(20)
        s.printer.faults.order(FaultOrder.parse("hotend-sensor=open"))
        s.host.expect("Printer halted", 5)
        halt_s = s.loop.time()
        said = s.host.expect("report of this halt", 5)
        assert s.loop.time() - halt_s == pytest.approx(halt_reports.AFTER_S, abs=0.02)
    (path,) = reports(tmp_path / "state")
    assert said == f"echo:The report of this halt is in {path}. Attach it when you ask for help"
    assert re.fullmatch(r"halt-0001-\d{8}-\d{6}\.txt", path.name)
    assert path.stat().st_size < 100_000
    found = sections(path)
    assert found[""][0] == "Passo 0.1.0: report of a halt"
    assert found["Cause"][1:] == [
        "code:   heat.sensor-open",
        "part:   heat",
        "what:   heater hotend was switched off: its sensor reads -20.0 °C; below 5.0 °C means a "
        "broken cable",
        "action: Check the sensor's plug and wires, then send M999",
    ]
    file, state, line, read, _ = found["Print"]
    assert (file, state) == ("file:   part.g", "state:  printing")
    number, offset = (int(re.search(r"\d+", text)[0]) for text in (line, read))
    assert 15 < number < 25
    ahead = PART.encode()[:offset].count(b"\n") - number
    assert 0 < ahead < 10  # the planner reads so many lines before they are executed
    consoles = [text.split(maxsplit=3) for text in found["Last lines of the consoles"]]
    assert [(c, way, text) for _, c, way, text in consoles[:2]] == [
        ("1", ">", "M104 S200"),
        ("1", "<", "ok"),
    ]
    assert float(consoles[0][0]) == pytest.approx(-50.46, abs=0.5)
    head, *curve = found["Heaters"]
    assert head.split() == ["hotend", "bed"]
    rows = [[float(n) for n in re.findall(r"-?\d+\.\d+", text)] for text in curve]
    assert 49 < len(rows) < 53  # one a second, and that of the halt
    assert rows[0] == [pytest.approx(-50.46, abs=0.5), 25, 0, 0, 25, 0, 0]
    assert rows[10][2:4] == [200, 1]  # target, power
    assert all(b[1] > a[1] for a, b in pairwise(rows[2:-3]))
    assert rows[-1] == [0, -20, 200, 0, 25, 0, 0]
    assert "failed" in curve[-1]
    assert "M92 X80 Y80 Z400 E95.5" in found["Settings (M503)"]
    assert 'heaters.hotend.sensor_pin = "T0"' in found["Machine"]


def test_emergency_stop_report_has_two_seconds_of_frames(tmp_path, card):
    with Scenario(card=card, state=str(tmp_path / "state")) as s:
        s.host.ok("M32 part.g")
        s.passes(20)
        s.host.send("M112")
        s.host.expect("report of this halt", 5)
    (path,) = reports(tmp_path / "state")
    found = sections(path)
    assert found["Cause"][1:3] == ["code:   machine.emergency-stop", "part:   job"]
    assert found["Frames of board main"][:2] == ["firmware 0.1.0", "clock 16000000 Hz"]
    rows = frames(found["Frames of board main"])
    assert rows[0][0] == pytest.approx(-2, abs=0.05)
    assert [row[0] for row in rows] == sorted(row[0] for row in rows)
    halt = next(i for i, row in enumerate(rows) if row[3] == "emergency_stop")
    assert [(sender, text.split()[0]) for _, sender, _, text in rows[halt : halt + 2]] == [
        ("host", "emergency_stop"),
        ("board", "shutdown"),
    ]
    assert rows[halt + 1][3].endswith("static_string_id=1 (Command request)")
    assert rows[halt][0] == pytest.approx(0, abs=0.02)
    steps = [text for _, sender, _, text in rows if sender == "host" and "queue_step" in text]
    assert len(steps) > 100
    assert steps[0].startswith(("queue_step oid=0 (stepper x)", "queue_step oid=1 (stepper y)"))
    for seconds, _, clock, _ in rows:  # both times tell the same
        assert (clock - rows[halt][2]) / 16e6 == pytest.approx(seconds - rows[halt][0], abs=1e-5)


def test_lost_link_report_ends_with_unanswered_frames(tmp_path, card):
    with Scenario(card=card, state=str(tmp_path / "state")) as s:
        s.host.ok("M32 part.g")
        s.passes(20)
        s.printer.faults.order(FaultOrder.parse("cable=cut"))
        s.host.expect("report of this halt", 20)
    (path,) = reports(tmp_path / "state")
    found = sections(path)
    assert found["Cause"][1] == "code:   machine.silent"
    rows = frames(found["Frames of board main"])
    before = [row for row in rows if row[0] < 0]
    assert {sender for _, sender, _, _ in before} == {"host"}  # the board has answered nothing
    assert len(before) > 10


def test_restart_at_once_keeps_frames_of_halt(tmp_path):
    with Scenario(state=str(tmp_path)) as s:
        s.host.send("M112", "M999")
        s.host.expect("ready again", 10)
        s.host.send("M112")
        s.passes(2)
    first, second = (sections(path) for path in reports(tmp_path))
    stops = [row for row in frames(first["Frames of board main"]) if row[3] == "emergency_stop"]
    assert len(stops) == 1
    assert len(second["Heaters"]) == 3  # of this start alone: one sample, and that of the halt


def test_end_of_program_writes_pending_report(tmp_path):
    with Scenario(reports=str(tmp_path / "my.log-halt")) as s:
        s.host.send("M112")
        s.host.expect("Printer halted", 1)
    (path,) = reports(tmp_path, "my.log-halt")
    assert sections(path)["Cause"][1] == "code:   machine.emergency-stop"


def test_failed_start_is_reported(tmp_path):
    machine = config.load("i3")
    hot = machine.heaters["hotend"].model_copy(update={"min_c": 30.0})
    cold = machine.model_copy(update={"heaters": machine.heaters | {"hotend": hot}})
    with Scenario(cold, state=str(tmp_path)) as s:
        s.passes(1)
    (path,) = reports(tmp_path)
    assert sections(path)["Cause"][1] == "code:   heat.min-temperature"


def test_last_ten_reports_are_kept(tmp_path):
    (tmp_path / "halt-0009-20260101-000000.txt").write_text("old")
    (tmp_path / "halt-notes.txt").write_text("of the user")
    with Scenario(state=str(tmp_path)) as s:
        for _ in range(11):
            s.host.send("M112")
            s.host.expect("report of this halt", 5)
            s.host.send("M999")
            s.host.expect("ready again", 10)
    numbers = [path.name[5:9] for path in reports(tmp_path)]
    assert numbers == [*(f"{n:04d}" for n in range(11, 21)), "note"]


def test_full_disk_is_a_warning_and_not_a_second_failure(tmp_path, monkeypatch, caplog):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    with Scenario(state=str(tmp_path)) as s:
        monkeypatch.setattr(Path, "write_text", full)
        s.host.send("M112")
        s.host.expect("^echo:The report of this halt could not be written: No space left", 5)
        assert s.printer.state.halted == "emergency stop by M112"
        monkeypatch.undo()
        s.host.send("M999")
        s.host.expect("ready again", 10)
    assert [r.levelname for r in caplog.records if r.name.endswith("halt_reports")] == ["WARNING"]
    assert reports(tmp_path) == []


def test_fault_of_report_does_not_stop_the_halt(tmp_path, monkeypatch):
    def broken(*_):
        raise KeyError("x")

    monkeypatch.setattr(halt_reports, "machine_text", broken)
    with Scenario(state=str(tmp_path)) as s:
        s.host.send("M112")
        s.host.expect("could not be written: an error of the program", 5)
        assert s.printer.state.halted
    assert reports(tmp_path) == []


def test_no_report_without_state_and_log():
    with Scenario() as s:
        s.host.send("M112")
        s.host.silent(2, "report")


def test_report_has_no_secret(tmp_path):
    with Scenario(state=str(tmp_path)) as s:
        s.host.ok('M587 S"net" P"geheim"')
        s.printer.stops.halt(in_words(ValueError(f"in {Path.home()}/printer.py")))
        s.host.expect("report of this halt", 5)
    (path,) = reports(tmp_path)
    text = path.read_text()
    assert "> M587 (not shown)" in text
    assert "ValueError: in ~/printer.py" in text
    assert "geheim" not in text and str(Path.home()) + "/" not in text
    assert s.machine.uuid not in text


def test_machine_text_hides_secrets_and_names():
    i3 = config.load("i3")
    board = i3.board.model_copy(update={"description": "at https://me:geheim@host/x"})
    text = machine_text(i3.model_copy(update={"board": board}))
    assert 'uuid = "(not shown)"' in text
    assert 'board.description = "at https://host/x"' in text
    assert "axes.x.max_mm = 250.0\n" in text
