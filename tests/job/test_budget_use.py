"""What the densest place of a file takes of board and link is told before it is printed."""

from __future__ import annotations

import re
from importlib.resources import files

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.cli.main import main
from passo.job.batch.board_load import BudgetUse, Place
from passo.job.batch.estimate import estimate
from passo.job.batch.simulated_print import Print

TEXT = files("passo.config").joinpath("machines", "i3.toml").read_text()
LINK = 'link = "serial"\nport = "/dev/x"\n'
FIRST = 203  # line of the dense place


@pytest.fixture
def dense(tmp_path):
    """Long moves, then a zigzag of 0.05 mm a move at 30 mm/s, then long moves again."""
    lines = ["G92 X0 Y0 Z0 E0", "M302 P1"]
    lines += [f"G1 X{50 * (i % 2)} F3000" for i in range(FIRST - 3)]
    lines += [f"G1 X{0.05 * i:.3f} Y{0.04 * (i % 2) + 0.05 * i:.3f} F1800" for i in range(600)]
    lines += [f"G1 X{50 * (i % 2)} F3000" for i in range(20)]
    path = tmp_path / "dense.g"
    path.write_text("\n".join(lines) + "\n")
    return path


def use(path, board):
    """The budget use of a file. The board `tool` moves Y, if there is one."""
    return estimate(config.load_text(moved("Y", board)), path).budget


def moved(socket, board):
    """A machine file with the motor of a socket on the board `tool`, if there is one."""
    if "[boards.tool]" not in board:
        return TEXT + board
    return TEXT.replace(f'socket = "{socket}"', f'socket = "tool:{socket}"') + board


def test_load_fractions_name_their_worst_line(dense):
    found = use(dense, LINK)
    assert found.densest.keys() == {"steps", "commands", "slots", "link"}
    link, commands, slots = (found.densest[n] for n in ("link", "commands", "slots"))
    assert FIRST <= link.line < FIRST + 600
    assert link.line == commands.line == slots.line
    per_s = commands.load * 0.3 * 16e6 / 1950
    assert link.load == pytest.approx((8.3 * per_s + 20 / 0.075) / 23_750)
    assert slots.load == pytest.approx(0.2 * per_s / 401)
    fastest = 50 * 80 * 90 / (0.65 * 16e6)  # on the long moves
    assert found.densest["steps"].load == pytest.approx(fastest)
    assert found.densest["steps"].line == 4


def test_unlimited_link_has_no_load_fraction(dense):
    assert use(dense, "").densest.keys() == {"steps", "commands", "slots"}


TOOL = '\n[boards.tool]\nbase = "ramps"\nlink = "serial"\nport = "/dev/y"\n'


def test_board_without_a_motor_has_no_load(dense):
    """A slow computer that only measures neither bounds the plan nor is named."""
    sensor = '[boards.pi]\nbase = "klipper"\nclock_hz = 1_000_000\nmove_count = 16\n'
    machine = config.load_text(f"{TEXT}\n{sensor}")
    found = estimate(machine, dense).budget
    assert found.densest.keys() == {"steps", "commands", "slots"}
    assert {place.board for place in found.densest.values()} == {""}
    assert machine.core_spec()["budgets"] == config.load_text(TEXT).core_spec()["budgets"]


def test_board_of_an_extruder_has_the_load_of_the_extruder_alone(dense):
    """Its slow processor and link do not bound moves without filament."""
    slow = LINK + TOOL + "baud = 9_600\nbudget = { cycles_per_step = 9000 }\n"
    free = estimate(config.load_text(TEXT + LINK), dense)
    machine = config.load_text(moved("E0", slow))
    found = estimate(machine, dense)
    assert found.total_s == free.total_s
    assert found.budget.worst == {} and found.budget.widened_s == 0
    loads = {kind: place.load for kind, place in free.budget.densest.items()}
    assert {kind: place.load for kind, place in found.budget.densest.items()} == loads
    assert {place.board for place in found.budget.densest.values()} == {""}

    with dense.open("a") as file:
        file.write("G1 X0 Y0 F3000\nG1 X50 E40\n")
    drawn = estimate(machine, dense).budget
    assert (drawn.densest["steps"].board, drawn.worst["steps"].board) == ("tool", "tool")
    assert drawn.densest["steps"].load == pytest.approx(1)
    asked = 40 * machine.steppers["e"].steps_per_mm / (0.65 * 16e6 / 9000)
    assert 1 < drawn.worst["steps"].load <= asked


def test_of_several_boards_the_limiting_one_is_reported(dense):
    """The tool's link is slower than the main board's, its processor faster."""
    tool = TOOL + "baud = 19_200\nmove_count = 2000\nbudget = { cycles_per_step = 80 }\n"
    found = use(dense, LINK + tool)
    alone = use(dense, LINK + "baud = 19_200\n")
    assert 0.9 < found.densest["link"].load < 1.3
    assert found.worst.keys() == {"link"}
    assert 1 < found.worst["link"].load < 0.7 * alone.worst["link"].load  # without X
    boards = {name: place.board for name, place in found.densest.items()}
    assert boards == {"steps": "", "commands": "", "slots": "", "link": "tool"}
    assert found.worst["link"].board == "tool"
    assert {place.board for place in alone.densest.values()} == {None}
    words = dict(found.shares())
    assert "processor of the main board, for steps" in words
    assert "link of the board tool" in words
    told, *_ = found.report_lines("a.g")
    assert "times what the link of the board tool takes," in told


@pytest.mark.parametrize(
    ("cycles", "link", "limits"),
    [
        (
            "step = 9000",
            LINK,
            {"steps": ("tool", "the processor of the board tool takes in steps")},
        ),
        (
            "command = 99_000",
            LINK,
            {"commands": ("tool", "the processor of the board tool takes in commands")},
        ),
        (
            "command = 1",
            LINK + "move_count = 20\n",
            {"slots": ("", "the move slots of the main board take")},
        ),
        (
            "step = 9000",
            LINK + "baud = 19_200\n",
            {
                "steps": ("tool", "the processor of the board tool takes in steps"),
                "link": ("", "the link of the main board takes"),
            },
        ),
    ],
)
def test_each_limit_that_did_not_hold_has_its_board(dense, cycles, link, limits):
    found = use(dense, link + TOOL + f"budget = {{ cycles_per_{cycles} }}\n")
    words = {
        name: (p.board, text)
        for (name, p), (text, _) in zip(found.worst.items(), found.limits(), strict=True)
    }
    assert words == limits


def test_a_long_pulse_counts_in_the_share_of_steps(dense):
    slow = TEXT.replace('socket = "X"', 'socket = "X"\ndriver = "TB6560"')
    found = estimate(config.load_text(slow), dense).budget.densest["steps"]
    assert found.load == pytest.approx(50 * 80 * (90 + 28 * 16) / (0.65 * 16e6))


def test_estimate_shows_load_fractions(dense, tmp_path, capsys):
    machine = tmp_path / "mine.toml"
    machine.write_text(TEXT + LINK)
    assert main(["estimate", str(dense), "--machine", str(machine)]) == 0
    out = capsys.readouterr().out
    assert re.search(r"^  link +\d+% at line \d+$", out, re.MULTILINE)


def on_the_wire(s):
    (sent,) = re.findall(r"(\d+) bytes, ", "\n".join(s.host.ok("M122")))
    return int(sent)


@pytest.mark.parametrize("speed", [60, 250])
def test_commits_count_in_the_load_of_the_link(tmp_path, speed):
    """A board with Passo's firmware is told one with each commit, the longer the faster it moves:
    on these lines most bytes are those."""
    lines = ["G92 X0 Y0 Z0 E0", f"G1 X5 Y5 F{60 * speed}"]
    lines += [f"G1 X{5 if i % 2 else 205} Y{5 + 2 * i}" for i in range(60)]
    (tmp_path / "lines.g").write_text("\n".join(lines) + "\n")
    machine = config.load_text(TEXT + 'firmware = "passo"\nbudget = { link_bytes_s = 10_944 }\n')
    share = estimate(machine, tmp_path / "lines.g").budget.densest["link"].load
    with Scenario(machine, card=str(tmp_path)) as s:
        s.host.ok("M32 lines.g")
        s.passes(20)
        before = on_the_wire(s)
        s.passes(10)
        taken = (on_the_wire(s) - before) / 10
    assert 0.5 * share < taken / 10_944 < share


def test_load_above_1_is_a_burst():
    told = BudgetUse(densest={"link": Place(7, 1.1), "slots": Place(8, 1.0)})
    assert told.shares() == [
        ("link", "110% at line 7, in a burst that is sent ahead"),
        ("move slots", "100% at line 8"),
    ]


def test_a_print_reports_a_place_that_is_close_to_the_limit(dense):
    text = TEXT + "budget = { cycles_per_step = 250 }\n"
    load = estimate(config.load_text(text), dense).budget.densest["steps"].load
    cycles = 250 * 0.9 / load
    close = config.load_text(TEXT + f"budget = {{ cycles_per_step = {cycles} }}\n")
    with Scenario(close, card=str(dense.parent)) as s:
        s.host.ok("M32 dense.g")
        told = s.host.expect("what the processor takes in steps", 5)
        shown = re.match(r"echo:dense.g:(\d+) takes (\d+)% of ", told)
        assert shown
        assert int(shown[2]) == 90
        assert told.endswith("print it more slowly or slice it with longer moves")


def test_low_board_load_is_not_reported(dense):
    with Scenario("i3", card=str(dense.parent)) as s:
        s.host.ok("M32 dense.g")
        s.passes(5)
        assert [line for line in s.host.heard if "dense.g:" in line or "densest" in line] == []


@pytest.mark.parametrize(("baud", "unsure"), [(38_400, True), (115_200, False)])
def test_too_few_commands_for_any_speed_are_reported(tmp_path, baud, unsure):
    path = tmp_path / "dense.g"
    lines = ["G92 X0 Y0 Z0 E0", "M302 P1"]
    lines += [f"G1 X{0.05 * i:.3f} Y{0.04 * (i % 2) + 0.05 * i:.3f} F6000" for i in range(600)]
    path.write_text("\n".join(lines) + "\n")
    found = use(path, f'{LINK}baud = {baud}\nfirmware = "klipper"\n')
    says = "Commands may come late there all the same: 440 a second are few. Use a faster link"
    assert any(line.startswith(says) for line in found.report_lines("f")) == unsure
    assert (found.unsure_s > 0) == unsure


def test_straight_lines_of_a_delta_bend_its_motors(tmp_path):
    """Its towers accelerate all along them: some twelve times the commands of straight motors. The
    densest place is a turn, with what speeds its motors up."""
    path = tmp_path / "infill.g"
    lines = ["G28", "G1 Z10 F3000"]
    lines += [f"G1 X{30 if i % 2 else -30} Y{0.4 * i - 12:.1f} F4800" for i in range(60)]
    path.write_text("\n".join(lines) + "\n")
    machine = config.load("delta")
    slots = estimate(machine, path).budget.densest["slots"].load
    taken_s = slots * machine.board.move_count / machine.board.ahead_s
    result = Print(machine).run(path)
    taken_on_average_s = result.queue_step_commands / result.move_time_s
    assert taken_on_average_s < taken_s < 1.6 * taken_on_average_s
