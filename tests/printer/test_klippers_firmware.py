"""A board with Klipper's firmware, in virtual time: its drivers are set up in the words of that,
and its switches end the search for home."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.support import trinamic_registers as r
from tests.support.klipper_board import dictionary
from tests.support.klipper_printer import STEPS_PER_MM, Board, Port, connected, machine
from tests.support.scenario import Scenario

from passo import _core
from passo.errors import MachineError


@pytest.fixture(params=["avr", "stm32, newer", "linux", "pru, newer"])
def board(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Board:
    chip, _, newer = request.param.partition(", ")
    it = Board(dictionary(chip=chip, newer=bool(newer)))
    monkeypatch.setattr("passo.printer.printer.connect", connected(Port(it)))
    return it


@pytest.fixture
def s(board: Board, tmp_path: Path) -> Iterator[Scenario]:
    with Scenario(machine(board.told, tmp_path)) as scenario:
        yield scenario
    assert board.wrong == []
    assert board.late == []


def field(board: Board, motor: str, register: int, name: str) -> int:
    chip = board.chips[motor]
    return r.fields(chip.name, register, chip.registers[register])[name]


def assert_there(s: Scenario, board: Board) -> None:
    """The mechanics are where the host takes them to be."""
    for axis, at in zip("xyz", s.printer.rig.job.machine_position[:3], strict=True):
        assert board.place(axis) == pytest.approx(at, abs=1.01 / STEPS_PER_MM[axis]), axis


def test_drivers_are_set_up_before_anything_moves(s: Scenario, board: Board) -> None:
    for motor, state in s.printer.drivers.states.items():
        chip = board.chips[motor]
        assert state.failure is None
        for register, value in state.settings.writes():
            if register != r.GSTAT:
                assert chip.registers[register] == value, (motor, hex(register))
        assert chip.registers[r.GSTAT] == 0
    assert {m: field(board, m, r.CHOPCONF, "mres") for m in "xyz"} == dict.fromkeys("xyz", 4)
    assert not any(name == "queue_step" for name, _ in board.said)
    s.host.silent(10, "driver|halted")


def test_klipper_firmware_homes_and_reports_position(s: Scenario, board: Board) -> None:
    s.host.ok("G28", 60)
    assert_there(s, board)
    s.host.ok("G1 X30 Y20 Z5 F3000")
    s.host.ok("M400", 30)
    assert s.printer.rig.job.machine_position[:3] == pytest.approx((30, 20, 5))
    assert_there(s, board)
    words = [name for name, _ in board.said]
    assert words.count("stepper_stop_on_trigger") >= 3
    assert s.host.ok("M119")


def test_an_endstop_that_is_triggered_already_is_left_first(s: Scenario, board: Board) -> None:
    s.host.ok("G28", 60)
    s.host.ok("G1 X0 Y0 Z0 F3000")
    s.host.ok("M400", 30)
    assert [board.place(axis) for axis in "xyz"] == pytest.approx([0, 0, 0], abs=1.01 / 80)
    s.host.ok("G28", 60)
    s.host.ok("G1 X10 Y10 Z1 F3000")
    s.host.ok("M400", 30)
    assert_there(s, board)


def test_a_short_circuit_stops_the_motors(s: Scenario, board: Board) -> None:
    s.host.ok("G28", 60)
    s.host.ok("G1 X200 F1200")
    s.passes(2)
    board.chips["x"].registers[r.DRV_STATUS] = 1 << 2
    s.host.expect("^Error:Printer halted: motor x: coil A has a short circuit to ground", 3)
    assert board.is_shutdown == 1
    stands = board.place("x")
    assert 20 < stands < 150
    s.passes(1)
    assert board.place("x") == stands


def test_a_board_that_was_reset_has_its_drivers_set_up_again(s: Scenario, board: Board) -> None:
    s.host.ok("G28", 60)
    s.host.ok("M906 X500")
    s.passes(1)
    irun = field(board, "x", r.IHOLD_IRUN, "irun")
    s.host.send("M112")
    s.host.expect("Printer halted", 5)
    for chip in board.chips.values():
        chip.power_on()
    s.host.send("M999")
    s.host.expect("ready again", 20)
    assert (board.resets, board.is_shutdown, board.is_config) == (1, 0, 1)
    assert field(board, "x", r.IHOLD_IRUN, "irun") == irun
    s.host.ok("G28", 60)
    s.host.ok("G1 X10 F3000")
    s.host.ok("M400", 30)
    assert_there(s, board)


def test_board_with_smaller_move_queue_is_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    board = Board(dictionary(chip="stm32", newer=True))
    monkeypatch.setattr("tests.oracles.klipper_mcu._MOVES", 200)
    monkeypatch.setattr("passo.printer.printer.connect", connected(Port(board)))
    with pytest.raises(
        MachineError, match="room for 200 commands, so write move_count = 200 there"
    ):
        Scenario(machine(board.told, tmp_path)).__enter__()


def test_second_start_resets_a_configured_board(board: Board, tmp_path: Path) -> None:
    for starts in (1, 2, 3):
        with Scenario(machine(board.told, tmp_path)) as s:
            assert (board.resets, board.is_config, board.is_shutdown) == (starts - 1, 1, 0)
            s.host.ok("G28", 60)
    assert board.wrong == []


def test_board_without_reset_command_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    told = dictionary(chip="avr", newer=False)
    del told["commands"]["reset"]
    board = Board(told)
    monkeypatch.setattr("passo.printer.printer.connect", connected(Port(board)))
    it = machine(told, tmp_path)
    with Scenario(it) as s:
        assert s.host.ok("M105")
    with pytest.raises(MachineError, match="the board is in use and cannot be restarted"):
        Scenario(it).__enter__()
    assert board.is_config == 1


def test_unexpected_board_restart_halts(s: Scenario, board: Board) -> None:
    s.host.ok("G28", 60)
    s.host.send("G1 X50 F600")
    s.passes(1)
    board._act_reset()
    for chip in board.chips.values():
        chip.power_on()
    s.host.expect("^Error:the board restarted", 2)
    s.host.expect("ready again", 10)
    assert (board.resets, board.is_shutdown, board.is_config) == (1, 0, 1)
    s.host.ok("G28", 60)
    s.host.ok("G1 X10 F3000")
    s.host.ok("M400", 30)
    assert_there(s, board)


@pytest.mark.parametrize(
    ("motor", "chip"), [("y", "TMC2209 on PB12"), ("z", "TMC2130 on PB13")], ids=("uart", "spi")
)
def test_missing_driver_prevents_motion(
    motor: str, chip: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    board = Board(dictionary(chip="stm32", newer=True))
    monkeypatch.setattr("passo.printer.printer.connect", connected(Port(board)))
    board.chips[motor].plugged = False
    with Scenario(machine(board.told, tmp_path)) as s:
        says = f"motor {motor}: its driver, a {chip}.* does not answer"
        failures = {m: state.failure for m, state in s.printer.drivers.states.items()}
        assert [m for m, failure in failures.items() if failure] == [motor]
        assert re.search(says, str(failures[motor]))
        s.host.send("G92 X0 Y0 Z0 E0", "G1 X10 F6000")
        s.host.expect(f"^Error:Printer halted: {says}", 2)
    assert not any(name == "queue_step" for name, _ in board.said)
    assert board.wrong == []


def test_the_simulated_board_speaks_the_words_of_that_firmware() -> None:
    """Tests that run on it are about boards with that firmware too."""
    told = dictionary(chip="stm32", newer=True)
    assert {text for _, text in _core.board_commands()} <= set(told["commands"])
    assert {text for _, text in _core.board_reports()} <= set(told["responses"])
