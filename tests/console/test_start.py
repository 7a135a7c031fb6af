"""How a printer starts and ends: what a first console hears, and heaters off whatever fails."""

from __future__ import annotations

import pytest
from tests.support.scenario import Host, Scenario

from passo import config
from passo.board.boards import Boards
from passo.board.drivers import Drivers
from passo.config.machine import MachineConfig
from passo.console.printer_console import welcome
from passo.errors import CardError, MachineError, PassoError
from passo.library.assembly import assembled
from passo.printer import printer as printer_module
from passo.printer.setup import connections


def welcomed(s: Scenario, host: Host) -> list[str]:
    async def open_it() -> None:
        welcome(s.machine.name, s.printer.state, host.session)

    before = len(host.heard)
    s.run(open_it())
    return host.heard[before:]


def test_the_first_console_gets_the_reason_for_unused_settings(tmp_path):
    (tmp_path / "settings.json").write_text("torn")
    with Scenario(state=str(tmp_path)) as s:
        start, name, why = welcomed(s, s.host)
        assert (start, name) == ("start", "echo:Passo, i3")
        assert "stored settings are not used: it is torn" in why
        assert welcomed(s, Host(s)) == ["start", "echo:Passo, i3"]


def test_missing_state_folder_is_reported(tmp_path):
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


def test_a_card_that_cannot_be_used_releases_the_board(tmp_path, closed):
    with pytest.raises(CardError):
        Scenario(card=str(tmp_path / "nothing"))
    assert len(closed) == 1


def test_a_board_that_fails_at_once_is_released(monkeypatch, closed):
    def fails(*_: object) -> None:
        raise PassoError.of("machine.place-unknown")

    monkeypatch.setattr("passo.printer.watch.driver_status.DriverWatch.set_up", fails)
    with pytest.raises(PassoError):
        Scenario()
    assert len(closed) == 1


def test_heaters_go_off_before_all_that_may_fail(closed):
    s = Scenario()
    ended: list[str] = []

    def fails() -> None:
        ended.append("failed" if closed else "too early")
        raise CardError.of("card.absent", value="pulled")

    s.printer.lifetime.at_end(lambda: ended.append("first opened"))
    s.printer.lifetime.at_end(fails)
    with pytest.raises(CardError), s:
        pass
    assert ended == ["failed", "first opened"]
    assert len(closed) == 1


def test_a_machine_is_assembled_within_a_loop_only():
    with pytest.raises(RuntimeError, match="no running event loop"):
        assembled(config.load("i3"))


# -- a machine that fails as the printer starts ----------------------------------------------------

OPEN, SHORTED = 1.0, 0.0


def policy(hotend: str, bed: str) -> MachineConfig:
    text = config.shipped_text("i3")
    text = text.replace("max_c = 285.0\n", f'max_c = 285.0\non_fault = "{hotend}"\n', 1)
    return config.load_text(
        text.replace("max_c = 120.0\n", f'max_c = 120.0\non_fault = "{bed}"\n', 1)
    )


@pytest.fixture
def broken(monkeypatch):
    """Sensors of the simulated board, with what they report, that are broken from the start."""
    sensors: dict[str, float] = {}

    def connect(machine):
        boards, simulated = connections.connect(machine)
        for name, ratio in sensors.items():
            simulated.force_sensor(name, ratio)
        return boards, simulated

    monkeypatch.setattr(printer_module, "connect", connect)
    return sensors


@pytest.mark.parametrize("sensor", ["hotend", "bed"])
@pytest.mark.parametrize("ratio", [OPEN, SHORTED])
def test_sensor_broken_at_start_halts_until_restart(broken, sensor, ratio):
    broken[sensor] = ratio
    with Scenario() as s:
        s.passes(5)
        said = welcomed(s, s.host)
        assert said[:2] == ["start", "echo:Passo, i3"]
        assert said[2].startswith(f"echo:Printer halted: heater {sensor} was switched off")
        assert said[2].endswith("send M999")
        assert not [line for line in s.host.heard if line.startswith("Error:")]
        assert welcomed(s, Host(s))[2] == said[2]  # the next console is told, too
        assert s.host.ok("M105")[0].startswith("ok T:")
        assert s.host.ok("G28")[0].startswith("echo:Printer stopped: heater")
        assert s.host.ok("M104 S200 F")[0].startswith("echo:Printer stopped: heater")
        again = s.host.ok("M999", 20)
        assert any(line.endswith("Then send M999 again") for line in again)
        s.board.force_sensor(sensor, None)
        assert "echo:The printer is ready again. Home it before you move it" in s.host.ok(
            "M999", 20
        )
        s.host.ok("G28", 60)
        assert s.positions()["x"] == pytest.approx(0, abs=0.02)
        s.host.ok("M109 S50", 300)
        assert s.printer.rig.connection.heaters["hotend"].celsius == pytest.approx(50, abs=1.5)


def test_failed_heater_is_named_at_start_and_after_m999(broken):
    broken["bed"] = OPEN
    with Scenario(policy("machine", "heater")) as s:
        assert "heater bed was switched off" in welcomed(s, s.host)[2]
        assert not s.printer.state.halted
        assert s.host.ok("G28", 60)[-1] == "ok"
        s.host.ok("M112")
        s.passes(1)
        answer = s.host.ok("M999", 20)
        assert any("heater bed was switched off" in line for line in answer)
        assert not s.printer.state.halted
        s.host.ok("G28", 60)
        assert s.positions()["x"] == pytest.approx(0, abs=0.02)


def test_a_driver_that_fails_at_the_start_halts(monkeypatch):
    def fails(*_):
        raise MachineError.of("machine.silent", value="get_uptime")

    with monkeypatch.context() as patch:
        patch.setattr(Drivers, "configure", fails)
        with Scenario() as s:
            s.passes(1)
            assert welcomed(s, s.host)[2].startswith("echo:Printer halted: ")
            patch.undo()
            s.host.ok("M999", 20)
            s.host.ok("G28", 60)
            assert s.positions()["x"] == pytest.approx(0, abs=0.02)


def test_a_card_does_not_start_itself_on_a_halted_printer(broken, tmp_path):
    broken["hotend"] = OPEN
    (tmp_path / "auto0.g").write_text("G92 X0\nG1 X10\n")
    with Scenario(card=str(tmp_path)) as s:
        s.passes(2)
        assert "echo:auto0.g was not started, for the printer is halted" in welcomed(s, s.host)
        assert s.positions()["x"] == 20
