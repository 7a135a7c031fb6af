"""Machine files with several boards."""

import pytest

from passo import config
from passo._core import Job
from passo.config.board_defaults import bindings
from passo.config.load import load_text, shipped_text
from passo.errors import ConfigError
from passo.toolchain.targets import target

TOOL = '\n[boards.tool]\nbase = "ramps"\n'


def machine_text(*changes: tuple[str, str], tool: str = TOOL) -> str:
    text = shipped_text("i3")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text + tool


def problems(text: str) -> list[str]:
    with pytest.raises(ConfigError) as error:
        load_text(text)
    return [str(problem) for problem in error.value.problems]


def test_a_name_before_the_colon_is_the_board() -> None:
    bed = (('"D8"', '"tool:D8"'), ('"T1"', '"tool:T1"'))
    machine = load_text(machine_text(('socket = "E0"', 'socket = "tool:E0"'), *bed))
    spec = machine.core_spec()
    assert spec["boards"] == 2
    assert [s["board"] for s in spec["steppers"]] == [0, 0, 0, 1]
    assert spec["output_boards"] == [0, 1, 0]  # hotend, bed, fan


def test_one_pin_of_each_board_has_an_owner_of_its_own() -> None:
    hotend = (('"D10"', '"tool:D8"'), ('"T0"', '"tool:T1"'), ('"D9"', '"tool:D9"'))
    machine = load_text(machine_text(*hotend))
    assert machine.pin(machine.heaters["hotend"].pin) == machine.pin(machine.heaters["bed"].pin)
    found = {b.key: b for b in bindings(machine)}
    assert (found["heaters.hotend.pin"].pin, found["heaters.hotend.pin"].original) == ("PH5", None)
    assert not found["heaters.hotend.pin"].rebound
    twice = machine_text(*hotend, ('"D8"', '"tool:D8"'), ('"T1"', '"tool:T0"'))
    assert "heaters.bed.pin" in problems(twice)[0]
    assert "belongs to heaters.hotend.pin" in problems(twice)[0]


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ([('socket = "Z"', 'socket = "took:Z"')], "steppers.z.socket is 'took:Z'"),
        (
            [('"^Z_MIN"', '"^took:Z_MIN"')],
            "the name of one of the boards before the colon",
        ),
        ([('"^Z_MIN"', '"^tool:Z_MUN"')], "homing.z.pin is '^tool:Z_MUN'"),
        ([('"D10"', '"tool:D10"')], "a pin of the board of heaters.hotend.pin, tool"),
        ([('"D9"', '"tool:D9"')], "a pin of the board of heaters.hotend.pin, the main one"),
        (
            [('socket = "Z"', 'socket = "Z"\nenable_pin = "tool:D38"')],
            "a pin of the board of steppers.z.socket, the main one",
        ),
        (
            [('base = "ramps"', 'base = "ramps"\ndrift_ppm = 5.0')],
            "time is this board",
        ),
    ],
)
def test_wrong_board_tables_are_named(changes: list[tuple[str, str]], says: str) -> None:
    assert any(says in text for text in problems(machine_text(*changes))), problems(
        machine_text(*changes)
    )


def test_a_further_board_is_described_as_the_main_one_is() -> None:
    found = problems(machine_text(tool='\n[boards.tool]\nbase = "rumps"\nbaud = 1\n'))
    assert any("boards.tool.base is 'rumps'" in text for text in found)
    assert any("boards.tool.baud" in text for text in found)
    found = problems(machine_text(tool='\n[boards.tool]\nbase = "ramps"\nlink = "serial"\n'))
    assert any("boards.tool.port is missing" in text for text in found)
    assert any("simulated, as board is" in text for text in found)


def test_a_driver_on_a_further_board_is_selected_by_its_socket() -> None:
    motor = 'socket = "tool:E0"\ndriver = "TMC2130"\n[steppers.e.tmc]\nrun_current_a = 0.5\n'
    bus = 'clock_pin = "tool:D23"\nmosi_pin = "tool:D25"\nmiso_pin = "tool:D27"\n'
    found = {
        b.key: b.pin for b in bindings(load_text(machine_text(('socket = "E0"', motor + bus))))
    }
    assert found["steppers.e.tmc.cs_pin"] == "PL7"


def test_firmware_is_built_for_the_motors_of_a_board(tmp_path) -> None:
    path = tmp_path / "two.toml"
    path.write_text(machine_text(('socket = "E0"', 'socket = "tool:E0"')))
    assert [m.name for m in target(str(path)).motors] == ["x", "y", "z"]
    tool = target(f"{path}:tool")
    assert (tool.name, [m.name for m in tool.motors]) == ("i3-tool", ["e"])
    assert tool.motors[0].step_pin == config.load_board("ramps").sockets["E0"].step


def test_each_board_with_a_motor_has_its_own_budget() -> None:
    """The second one is slow at commands, the main one at steps."""
    main = "budget = { cycles_per_step = 1000 }"
    tool = "budget = { cycles_per_command = 9000 }"
    moved = ('socket = "E0"', 'socket = "tool:E0"')
    text = machine_text(moved).replace("[board]", f"[board]\n{main}") + f"\n{tool}\n"
    machine = load_text(text)
    boards = {name: board.budget_spec() for name, board in machine.all_boards.items()}
    own = [boards[""] | {"boards": [0]}, boards["tool"] | {"boards": [1]}]
    assert machine.core_spec()["budgets"] == own
    assert own[0]["steps_s"] < own[1]["steps_s"]
    assert own[0]["commands_s"] > own[1]["commands_s"]


def test_boards_beyond_the_fourth_budget_share_its_minimum() -> None:
    board = '[boards.{}]\nbase = "ramps"\nbudget = {{ cycles_per_command = {} }}\n'
    text = machine_text(tool="")
    for i, socket in enumerate(("X", "Y", "Z", "E0")):
        text = text.replace(f'socket = "{socket}"', f'socket = "b{i}:{socket}"')
        text += board.format(f"b{i}", 9000 + i)
    text += "[axes.u]\nmin_mm = 0.0\nmax_mm = 9.0\nspeed_mm_s = 5.0\naccel_mm_s2 = 50.0\n"
    machine = load_text(text + '[steppers.u]\nsocket = "E1"\nsteps_per_mm = 80.0\n')
    assert machine.budget_groups == [[""], ["b0"], ["b1"], ["b2", "b3"]]
    *_, last = machine.core_spec()["budgets"]
    weakest = machine.all_boards["b3"].budget_spec()
    assert weakest is not None
    assert last == weakest | {"boards": [3, 4]}
    assert Job(machine.core_spec()).results.statistics()["densest"]["steps_s"] == [(0, 0.0)] * 4
