"""What boards and their links take, for the planner."""

from __future__ import annotations

import json
from math import inf
from pathlib import Path

import pytest

from passo import config
from passo.config.board import Board

from .test_pins import KLIPPER

SERIAL = {"link": "serial", "port": "/dev/x"}
KLIPPERS_LINK = 23_750  # bytes/s at its 250 000 baud


def klippers(text: str, link: str = 'link = "serial"\nport = "/dev/x"') -> Board:
    dictionary = 'dictionary = "board.dict"'
    assert dictionary in KLIPPER
    return config.load_text(KLIPPER.replace(dictionary, f"{link}\n{text}")).board


@pytest.mark.parametrize("base", config.shipped_boards())
def test_a_low_baud_rate_bounds_every_board(base: str) -> None:
    board = config.load_board(base).model_copy(update=SERIAL | {"baud": 19_200})
    assert board.link_bytes_s == pytest.approx(1824)
    spec = board.budget_spec()
    assert spec
    assert spec["bound"] == "link"
    assert spec["commands_s"] == pytest.approx((1824 - board.commit_bytes_s) / 8.3)


@pytest.mark.parametrize(("stated", "carried"), [(23_750, 1824), (1000, 1000)])
def test_a_stated_link_never_widens_a_serial_one(
    i3_text: str, stated: float, carried: float
) -> None:
    serial = 'link = "serial"\nport = "/dev/x"\nbaud = 19_200\n'
    machine = config.load_text(i3_text + f"{serial}budget = {{ link_bytes_s = {stated} }}\n")
    assert machine.board.link_bytes_s == carried


def test_a_board_without_a_budget_is_bound_by_its_link() -> None:
    board = config.load("i3").board.model_copy(update={"budget": None})
    assert board.budget_spec() is None
    rate = (10_944 - 20 / 0.075) / 8.3
    assert board.model_copy(update=SERIAL | {"baud": 115_200}).budget_spec() == {
        "steps_s": inf,
        "commands_s": pytest.approx(rate),
        "burst": pytest.approx(0.035 * rate),
        "bound": "link",
        "commits_s": pytest.approx(1 / 0.075),
    }


@pytest.mark.parametrize(
    ("clock_hz", "steps_s", "commands_s"),
    [
        (16_000_000, 0.65 * 16e6 / 164, 0.3 * 16e6 / 1950),
        (20_000_000, 0.65 * 20e6 / 164, KLIPPERS_LINK / 8.3),
        (12_000_000, 0.65 * 120e6 / 300, KLIPPERS_LINK / 8.3),  # an RP2040, whose core is faster
        (48_000_000, 0.65 * 48e6 / 300, KLIPPERS_LINK / 8.3),
        (180_000_000, 0.65 * 180e6 / 300, KLIPPERS_LINK / 8.3),
    ],
)
def test_a_board_with_klippers_firmware_has_a_budget(
    clock_hz: int, steps_s: float, commands_s: float
) -> None:
    board = klippers(f"clock_hz = {clock_hz}\nmove_count = 1024")
    spec = board.budget_spec()
    assert spec
    assert spec["steps_s"] == pytest.approx(steps_s)
    assert spec["commands_s"] == pytest.approx(commands_s)
    certain = klippers(f"clock_hz = {clock_hz}").budget_spec()  # no more slots than these
    assert certain
    assert certain["commands_s"] == pytest.approx(min(commands_s, 256 / 0.15))
    assert certain["burst"] == 128
    longer = board.budget_spec(3.0)  # the end of a pulse that long is an event of its own
    assert longer
    assert longer["steps_s"] == pytest.approx(steps_s / 2)


def test_a_board_waits_while_a_pulse_lasts() -> None:
    board = config.load_board("stm32f407-discovery")
    wired = board.model_copy(update={"link": "serial", "baud": 250_000})
    rates = [spec["steps_s"] for us in (0.1, 0.3, 2.0) if (spec := wired.budget_spec(us))]
    assert rates == pytest.approx([364_000, 364_000, 0.65 * 168e6 / (300 + 1.7 * 168)])


def test_a_shipped_board_may_run_klippers_firmware(i3_text: str) -> None:
    """Its own budget is of Passo's; what the machine file states itself still counts."""
    serial = 'link = "serial"\nport = "/dev/x"\n'
    own = config.load_text(f"{i3_text}{serial}").board
    assert (own.is_klippers, own.survives) == (False, True)
    assert own.budget and own.budget.cycles_per_step == 90
    board = config.load_text(f'{i3_text}{serial}firmware = "klipper"\n').board
    assert (board.is_klippers, board.survives) == (True, False)
    assert board.budget and board.budget.cycles_per_step == 164
    assert board.pin("X_STEP") == "PF0"
    stated = f'{serial}firmware = "klipper"\nbudget = {{ cycles_per_step = 120 }}\n'
    board = config.load_text(i3_text + stated).board
    assert board.budget and board.budget.cycles_per_step == 120


def test_a_machine_file_states_what_it_knows_better() -> None:
    """One key of a budget leaves the others; a USB port carries more than its baud rate says."""
    stated = "budget = { link_bytes_s = 400_000, cycles_per_step = 120 }"
    board = klippers(f"clock_hz = 72_000_000\nmove_count = 2000\n{stated}")
    assert board.link_bytes_s == 400_000
    spec = board.budget_spec()
    assert spec
    assert spec["steps_s"] == pytest.approx(0.65 * 72e6 / 120)
    assert spec["commands_s"] == pytest.approx(0.3 * 72e6 / 1950)
    assert spec["bound"] == "commands"


def test_the_clock_of_a_dictionary_counts(tmp_path: Path) -> None:
    pins = {f"P{port}{i}": 32 * n + i for n, port in enumerate("AB") for i in range(16)}
    content = {"config": {"CLOCK_FREQ": 72_000_000}, "enumerations": {"pin": pins}}
    (tmp_path / "board.dict").write_text(json.dumps(content))
    (tmp_path / "mine.toml").write_text(KLIPPER)
    spec = config.load(tmp_path / "mine.toml").core_spec()["budgets"][0]
    assert spec["steps_s"] == pytest.approx(0.65 * 72e6 / 300)


def test_own_clock_counts_before_that_of_shipped_board(tmp_path: Path, i3_text: str) -> None:
    pins = {f"P{port}{i}": 8 * n + i for n, port in enumerate("ABCDEFGHJKL") for i in range(8)}
    content = {"config": {"CLOCK_FREQ": 20_000_000}, "enumerations": {"pin": pins}}
    (tmp_path / "board.dict").write_text(json.dumps(content))
    runs = 'firmware = "klipper"\ndictionary = "board.dict"\n'
    (tmp_path / "mine.toml").write_text(i3_text + runs)
    assert config.load(tmp_path / "mine.toml").board.clock_hz == 20_000_000
    (tmp_path / "mine.toml").write_text(i3_text + runs + "clock_hz = 16_000_000\n")
    assert config.load(tmp_path / "mine.toml").board.clock_hz == 16_000_000


def test_board_with_klippers_firmware_is_one_of_several(i3_text: str) -> None:
    tool = '\n[boards.tool]\nbase = "klipper"\nclock_hz = 16_000_000\nmove_count = 100\n'
    pins = 'step_pin = "tool:PA1"\ndirection_pin = "tool:PA2"'
    moved = i3_text.replace('socket = "E0"', pins) + tool
    assert config.load_text(moved).core_spec()["budgets"][1]["burst"] == 50
