"""`passo init`: questions on the terminal, and the machine file that the answers make."""

import io
import sys
from pathlib import Path

import pytest

from passo import config
from passo.cli.main import main


@pytest.fixture
def init(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A function that runs `passo init` in a folder of its own with these answers."""

    def run(*answers: str) -> int:
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "stdin", io.StringIO("".join(f"{a}\n" for a in answers)))
        return main(["init"])

    return run


def _answers(**given: str) -> list[str]:
    """An answer to each question about a machine with four motors and two heaters."""
    names = [
        "machine",
        "name",
        "author",
        "description",
        "board",
        "port",
        "x",
        "y",
        "z",
        "sx",
        "sy",
        "sz",
        "se",
        "sensor",
        "max_c",
        "bed_sensor",
        "bed_max_c",
    ]
    return [given.get(name, "") for name in names]


def test_init_defaults_copy_the_machine_with_a_new_uuid(init, tmp_path: Path) -> None:
    assert init(*_answers()) == 0
    made, shipped = config.load(tmp_path / "my-i3.toml"), config.load("i3")
    assert made.uuid != shipped.uuid
    own = {"uuid", "name", "author", "description"}
    assert made.model_dump(exclude=own) == shipped.model_dump(exclude=own)


def test_answers_are_values_of_the_file(init, tmp_path: Path) -> None:
    answers = _answers(
        machine="corexy",
        name="box",
        author="Ada",
        description="A box",
        board="mks-gen-l",
        port="/dev/ttyUSB0",
        x="310",
        sx="160",
    )
    answers += ["", "", "", ""]  # the second motor of Z
    assert init(*answers) == 0
    made = config.load(tmp_path / "box.toml")
    assert (made.name, made.author, made.description) == ("box", "Ada", "A box")
    assert made.board.base == "mks-gen-l"
    assert (made.board.link, made.board.port) == ("serial", "/dev/ttyUSB0")
    assert made.axes["x"].max_mm == 310.0
    assert made.steppers["a"].steps_per_mm == 160.0


def test_a_wrong_answer_is_named_and_asked_again(
    init, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    answers = _answers(machine="i4", name="Mine", x="wide", sensor="ATC Semitec")
    answers[1:1] = ["i3"]
    answers[3:3] = ["mine"]
    answers[9:9] = ["-3"]
    answers[10:10] = ["200"]
    answers[18:18] = ["ATC Semitec 104GT-2"]
    assert init(*answers) == 0
    out = capsys.readouterr().out
    assert "There is no 'i4'. Known here: big-fish-i3, cnc," in out
    assert "name is 'Mine': expected a name of lower-case letters" in out
    assert "'wide' is not a number." in out
    assert "Names like it: 'ATC Semitec 104GT-2'" in out
    made = config.load(tmp_path / "mine.toml")
    assert made.axes["x"].max_mm == 200.0
    assert made.heaters["hotend"].max_c == 285.0


def test_init_asks_for_missing_functions_of_the_board(
    init, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert init(*_answers(board="radds"), "E1") == 0
    assert "steppers.e.socket is 'E0': expected a socket of the board." in capsys.readouterr().out
    assert config.load(tmp_path / "my-i3.toml").steppers["e"].socket == "E1"


def test_init_lists_remaining_errors(
    init, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert init(*_answers(board="radds"), "") == 0
    *_, left, following = capsys.readouterr().out.splitlines()
    assert "To correct, line 43: steppers.e.socket is 'E0': expected a socket of the" in left
    assert following == "Next: passo check my-i3.toml"
    assert main(["check", str(tmp_path / "my-i3.toml")]) == 3


def test_a_file_is_never_replaced(init, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "my-i3.toml").write_text("precious")
    assert init(*_answers()) == 4
    assert (tmp_path / "my-i3.toml").read_text() == "precious"
    assert capsys.readouterr().err == "my-i3.toml: exists already. Choose another name.\n"


def test_end_of_input_during_init_leaves_no_file(init, tmp_path: Path) -> None:
    assert init("i3", "mine") == 130
    assert list(tmp_path.iterdir()) == []
