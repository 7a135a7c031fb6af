"""M999 is a wait: its `ok` comes when the printer is ready again, or has not become so."""

import pytest
from tests.support.scenario import Host, Scenario

from passo import config


@pytest.fixture
def s():
    with Scenario("i3", free=True) as scenario:
        yield scenario


def at_once(s, *texts):
    """Hosts send in the same moment: nothing happens between."""

    async def receive():
        for host, text in texts:
            host.session.receive(text)

    s.run(receive())


def test_lines_after_m999_find_the_printer_ready(s):
    s.host.ok("M112")
    s.passes(1)
    s.host.send("M999", "G28", "M104 S50", "G1 X5 F6000", "M400")
    for _ in range(5):
        s.host.expect("^ok", 120)
    assert not [line for line in s.host.heard if "Printer stopped" in line]
    assert s.printer.rig.connection.heaters["hotend"].target == 50
    assert s.positions()["x"] == 5


def test_m999_directly_after_emergency_stop_restarts(s):
    s.host.send("M112", "M999", "G92 X0 Y0 Z0", "G1 X5 F6000", "M400")
    for _ in range(5):
        s.host.expect("^ok", 10)
    assert not s.printer.state.halted
    ready = s.host.heard.index("echo:The printer is ready again. Home it before you move it")
    assert s.host.heard[:ready].count("ok") == 1  # of M112
    assert s.host.ok("M114")[0].startswith("X:5.00")


def test_emergency_stop_during_restart_halts(s):
    other = Host(s)
    at_once(s, (s.host, b"M112\nM999\n"), (other, b"M112\n"))
    s.host.expect("Printer stopped: emergency stop by M112")
    assert s.host.ok("G28") == [
        "echo:Printer stopped: emergency stop by M112. Make the printer safe, then send M999",
        "ok",
    ]
    s.passes(5)
    assert s.printer.state.halted
    other.ok("M999")
    assert not s.printer.state.halted


def test_emergency_stop_sent_right_after_m999_halts(s):
    s.host.ok("M112")
    s.passes(1)
    s.host.send("M999", "M112", "G28")
    s.host.expect("ready again", 3)
    s.host.expect("Printer stopped: emergency stop by M112", 3)
    s.passes(5)
    assert s.printer.state.halted == "emergency stop by M112"


@pytest.mark.parametrize("question", ["M119", "M114 R", "M114 D"])
def test_a_stopped_board_reports_nothing_more(s, question):
    s.host.send("M112")
    s.passes(1)
    *_, told, ok = s.host.ok(question)
    assert told == (
        "echo:the board is stopped and reports nothing: emergency stop by M112."
        " Make the printer safe, then send M999."
    )
    assert ok == "ok"
    assert s.host.ok("M114")[0].startswith("X:0.000 Y:0.000 Z:0.000 E:0.0000 Count")


def test_m999_without_a_halt_does_nothing(s):
    assert s.host.ok("M999") == ["ok"]


def test_other_consoles_are_answered_during_restart(s):
    other = Host(s)
    at_once(s, (s.host, b"M112\nM999\n"), (other, b"M105\n"))
    other.expect("ready again")
    ready = other.heard.index("echo:The printer is ready again. Home it before you move it")
    assert [line for line in other.heard[:ready] if line.startswith("ok T:")]


def test_restart_completes_after_host_left(s):
    other = Host(s)

    async def go():
        s.host.session.receive(b"M112\nM999\n")
        s.host.session.close()

    s.run(go())
    other.expect("ready again")
    assert not s.printer.state.halted


def test_restart_ends_if_board_is_unreachable(s, monkeypatch):
    from passo.errors import MachineError

    s.host.ok("M112")
    s.passes(1)

    def gone(_):
        raise MachineError.of("machine.program", value="no board")

    monkeypatch.setattr("passo.printer.printer.reconnected", gone)
    heard = s.host.ok("M999")
    assert "Then send M999 again" in heard[0]
    assert "Printer stopped" in heard[1]
    monkeypatch.undo()
    s.host.ok("M999")
    assert not s.printer.state.halted


def test_internal_error_during_restart_halts_again(s, monkeypatch):
    s.host.ok("M104 S50")
    s.host.ok("M112")
    s.passes(1)
    with monkeypatch.context() as patch:
        patch.setattr(s.printer.dispatch, "take_setting", lambda *_: 1 / 0)
        heard = s.host.ok("M999")
    assert heard[0].startswith("Error:a fault of the program, ZeroDivisionError: division by zero.")
    assert heard[0].endswith("Then send M999 again")
    assert "a fault of the program" in heard[1]
    assert s.host.ok("G28")[0].startswith("echo:Printer stopped: a fault of the program")
    s.passes(5)
    assert s.printer.state.halted
    s.host.ok("M999")
    assert not s.printer.state.halted
    assert s.host.ok("G28", 60) == ["ok"]


@pytest.mark.parametrize("line", ["M290 Z0.03", "M220 S50"])
def test_plan_changes_do_not_act_while_halted(s, line):
    s.host.ok("G28", 60)
    s.host.send("G28 X")
    s.passes(0.5)
    s.host.send(line, "M112")
    s.host.expect("Printer stopped: emergency stop by M112", 3)
    assert s.printer.motion.offsets.babysteps_mm["z"] == 0
    assert s.printer.rig.job.limits.speed_factor == 1
    assert s.host.ok("M410") == ["ok"]
    s.host.ok("M999")
    assert s.host.ok("G28", 60) == ["ok"]


@pytest.mark.parametrize("seconds", [0.05, 0.5, 1.0, 2.0])
def test_a_stop_of_a_halted_printer_is_answered_and_does_nothing(s, monkeypatch, seconds):
    s.host.send("G28")
    s.passes(seconds)
    s.host.send("M112")
    s.passes(0.1)
    monkeypatch.setattr(s.printer.rig.queue, "stop", lambda: 1 / 0)
    assert s.host.ok("M410")[-1] == "ok"
    assert s.printer.state.halted == "emergency stop by M112"


def test_m999_sent_before_failure_is_refused(s):
    """Not what stood behind a wait when the heater failed, nor what follows that."""
    s.board.force_heater("hotend", 0.0)
    s.host.send("M109 S200", "M999", "M104 S180 F", "M118 end")
    s.host.expect("^Error:Printer halted: heater hotend was switched off", 40)
    assert "M999 is not carried out: the printer has failed since" in s.host.expect("M999 is", 1)
    s.passes(5)
    assert s.printer.state.halted
    assert s.board.output_value("hotend") == 0
    s.host.ok("M999")
    assert not s.printer.state.halted


def test_emergency_stop_of_another_host_stays_in_force():
    with Scenario("i3") as s:
        other = Host(s)
        s.host.send("M109 S200", "M999", "M104 S180 F")
        s.passes(1)
        other.ok("M112")
        s.host.expect("M999 is not carried out", 1)
        s.passes(5)
        assert s.printer.state.halted
        assert s.board.output_value("hotend") == 0


def test_m922_sent_before_failure_is_refused():
    text = config.shipped_text("i3")
    text = text.replace("max_c = 285.0\n", 'max_c = 285.0\non_fault = "heater"\n', 1)
    with Scenario(config.load_text(text)) as s:
        s.host.send("M190 S60", "M922")
        s.passes(1)
        s.board.force_sensor("hotend", 1.0)
        s.passes(1)
        s.host.send("M108")
        s.passes(1)
        heater = s.printer.rig.connection.heaters["hotend"]
        assert heater.fault is not None
        assert [line for line in s.host.heard if line.startswith("echo:M922 is not carried out")]
        s.board.force_sensor("hotend", None)
        assert "armed again" in s.host.ok("M922")[0]
        assert heater.fault is None


@pytest.mark.parametrize("line", ["RESTART", "firmware_restart"])
def test_restart_by_name_halts_first_and_its_ok_comes_when_ready(s, line):
    s.host.ok("M104 S50")
    assert s.host.ok(line, 120)[-1] == "ok"
    assert not s.printer.state.halted
    assert s.printer.rig.connection.heaters["hotend"].target == 0
    assert not [text for text in s.host.heard if text.startswith("Error:")]
    assert s.host.ok("G1 X5")[0].startswith("echo:")  # not homed


def test_restart_by_name_ends_an_emergency_stop(s):
    s.host.send("M112", "RESTART", "G92 X0 Y0 Z0", "G1 X5 F6000", "M400")
    for _ in range(5):
        s.host.expect("^ok", 10)
    assert s.host.ok("M114")[0].startswith("X:5.00")


def test_restart_that_was_sent_before_an_emergency_stop_is_refused(s):
    other = Host(s)
    at_once(s, (s.host, b"G28\nRESTART\n"), (other, b"M112\n"))
    s.passes(5)
    assert s.printer.state.halted
    assert any("RESTART is not carried out" in text for text in s.host.heard)
