"""`passo machines`, `passo check`, and what the passo command does with wrong words."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from passo import config
from passo.cli.main import COMMANDS, main
from passo.job.settings_store import Override, Setting, Store


def test_machines_prints_a_row_a_machine(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["machines"]) == 0
    head, *rows = capsys.readouterr().out.splitlines()
    assert head.split() == ["NAME", "GEOMETRY", "SIZE", "MM", "STEPPERS", "BOARD"]
    assert [row.split()[0] for row in rows] == config.shipped_machines()
    (i3,) = (row for row in rows if row.startswith("i3 "))
    assert i3.split("  ")[0] == "i3"
    assert "cartesian" in i3
    assert "250 x 220 x 250" in i3
    assert "x y z e " in i3
    assert i3.endswith("RAMPS 1.4")


def test_machines_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["machines", "--json"]) == 0
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)}
    assert rows["big-fish-i3"]["steppers"] == ["x", "y", "z", "z1", "e"]
    assert rows["delta"]["size_mm"] == [150.2, 150.2, 180.0]


@pytest.mark.parametrize("name", ["voron-2-4", "voron-0", "ender3-v2", "prusa-mk3s", "kossel"])
def test_machines_with_the_firmware_of_klipper_print(
    name: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "square.gcode"
    path.write_text(
        "M190 S60\nM109 S205\nG28\nG1 Z0.2 F900\nG1 X40 Y30 F3000\nG1 X60 E2 F1500\n"
        "G1 Y50 E4\nG1 X40 E6\nG1 Y30 E8\nM104 S0\n"
    )
    assert main(["print", str(path), "--machine", name]) == 0
    rows = dict(
        line.split("  ", 1) for line in capsys.readouterr().out.splitlines() if "  " in line
    )
    assert rows["lines, moves, arcs"].strip() == "10, 6, 0"
    assert rows["filament"].strip() == "e 8.0 mm"


def test_machines_prints_the_file_of_a_machine(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["machines", "rotary-delta"]) == 0
    (tmp_path / "mine.toml").write_text(capsys.readouterr().out, encoding="utf-8")
    assert config.load(tmp_path / "mine.toml") == config.load("rotary-delta")
    assert main(["machines", "rotary_delta"]) == 3
    assert "'rotary_delta'. Did you mean 'rotary-delta'?" in capsys.readouterr().err


def test_check_of_a_valid_file_succeeds(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "scara"]) == 0
    out, err = capsys.readouterr()
    assert out == "scara: ok: scara, scara, 3 axes, 4 steppers, RAMPS 1.4\n"
    assert err == ""


def test_check_shows_default_pin_next_to_a_changed_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    text = config.shipped_text("i3").replace('pin = "D9"', 'pin = "PB5"')
    path.write_text(text.replace('socket = "E0"', 'socket = "E0"\nstep_pin = "D40"'))
    assert main(["check", str(path)]) == 0
    out, _ = capsys.readouterr()
    assert out.splitlines()[1:] == [
        "  steppers.e.step_pin: D40 (PG1), the board's own is E0_STEP (PA4)",
        "  fans.part.pin: PB5, the board's own is D9 (PH6)",
    ]
    assert main(["check", "--json", str(path)]) == 0
    rows = {row["key"]: row for row in json.loads(capsys.readouterr().out)["pins"]}
    assert rows["fans.part.pin"] == {
        "key": "fans.part.pin",
        "name": "PB5",
        "pin": "PB5",
        "original_name": "D9",
        "original": "PH6",
        "rebound": True,
    }
    assert rows["steppers.x.enable_pin"]["pin"] == "!PD7"
    assert not rows["steppers.x.enable_pin"]["rebound"]


def test_check_questions_gains_of_another_unit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    head = "[heaters.hotend]\n"
    gains = 'control = { kind = "pid", kp = 0.08 }\n'
    path.write_text(config.shipped_text("i3").replace(head, head + gains))
    assert main(["check", str(path)]) == 0
    question = capsys.readouterr().out.splitlines()[1]
    assert question.startswith("  Question: ")
    assert "heaters.hotend.control.kp is 0.08: a hotend has 1.5 to 1000" in question
    assert question.endswith("Did you mean kp = 20.4 (multiplied by 255)?")
    assert main(["check", "--json", str(path)]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["ok"] is True
    assert [row["code"] for row in report["questions"]] == ["config.gain"]


def test_check_lists_what_the_state_folder_overrides(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, state = tmp_path / "mine.toml", tmp_path / "state"
    real = '[board]\nlink = "serial"\nport = "/dev/nothing"\n'
    path.write_text(config.shipped_text("i3").replace("[board]\n", real))
    assert main(["check", str(path), "--state", str(state)]) == 0
    assert capsys.readouterr().out.splitlines()[1:] == [f"  Nothing in {state} overrides it"]
    assert not state.exists()
    store = Store(state / "settings.json", config.load("i3").uuid)
    store.save([Override(Setting("M92", "X", "100"), "70")])
    before = store.path.read_bytes()
    named = (
        "Stored M92 X100 overrides X80 of the machine file. The file was edited after M500: it had"
        " X70"
    )
    assert main(["check", str(path), "--state", str(state)]) == 0
    assert capsys.readouterr().out.splitlines()[1] == f"  {named}"
    assert main(["check", "--json", str(path), "--state", str(state)]) == 0
    assert json.loads(capsys.readouterr().out)["stored"][0] == named
    assert store.path.read_bytes() == before
    store.path.write_text("torn")
    assert main(["check", str(path), "--state", str(state)]) == 4
    assert "the stored settings are not used: it is torn" in capsys.readouterr().err
    assert main(["check", "--json", str(path), "--state", str(state)]) == 4
    report = json.loads(capsys.readouterr().out)
    assert (report["ok"], report["problems"][0]["code"]) == (False, "settings.unreadable")


def test_check_names_the_boards_whose_pins_are_unknown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    tool = '\n[boards.tool]\nbase = "klipper"\nclock_hz = 16_000_000\n'
    text = config.shipped_text("i3") + tool
    path.write_text(text.replace('pin = "D9"', 'pin = "tool:PZ9"').replace('fan = "part"', ""))
    assert main(["check", str(path)]) == 0
    ok, *notes = capsys.readouterr().out.splitlines()
    assert ok.endswith(" (pins not checked)")
    assert notes == [
        "  Note: the pins on boards.tool are not checked: its firmware's dictionary is not known."
        ' Give boards.tool the key dictionary = "klipper.dict", the file of the firmware\'s build'
    ]
    assert main(["check", "--json", str(path)]) == 0
    assert json.loads(capsys.readouterr().out)["unchecked_boards"] == ["boards.tool"]


def test_check_lists_assumed_heaters(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(re.sub(r"(?m)^simulated = .*\n", "", config.shipped_text("i3")))
    assert main(["check", str(path)]) == 0
    assert capsys.readouterr().out.splitlines()[1:] == [
        f"  Note: heaters.{name} is taken to be a {name} that full power heats to {hottest} °C, and"
        " its readings are not compared with a model."
        f" M303 H{number} R5 finds the model of this one"
        for name, hottest, number in (("hotend", 405, 0), ("bed", 135, -1))
    ]


def test_check_of_an_invalid_file_lists_errors(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.toml"
    path.write_text("name = 5\nuuid = 'x'\n")
    assert main(["check", str(path)]) == 3
    out, err = capsys.readouterr()
    assert out == ""
    assert f"{path}:1: name is 5: expected a text in quotes. Correct the value.\n" in err
    assert f"{path}:2: uuid is 'x': expected a UUID" in err


def test_check_of_an_invalid_file_as_json_lists_errors(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.toml"
    path.write_text("name = 'x'\nname = 'y'\n")
    assert main(["check", "--json", str(path)]) == 3
    out, err = capsys.readouterr()
    report = json.loads(out)
    assert report["ok"] is False
    assert [(p["code"], p["line"]) for p in report["problems"]] == [("config.syntax", 2)]
    assert err == ""


def test_any_content_of_a_bad_file_can_be_written_as_json(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.toml"
    text = config.shipped_text("i3").replace("max_mm = 250.0", "max_mm = [1979-05-27, nan]")
    path.write_text(text)
    assert main(["check", "--json", str(path)]) == 3
    report = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert report["problems"][0]["values"]["value"] == ["1979-05-27", "nan"]


@pytest.mark.parametrize("words", [[], ["prnit"], ["machines", "--yaml"], ["check"]])
def test_machines_usage_errors_exit_with_2(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("usage: passo")


def test_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    out = capsys.readouterr().out
    for command in COMMANDS:
        assert f"\n    {command} " in out or f"\n    {command}\n" in out


@pytest.mark.parametrize("command", COMMANDS)
def test_every_option_has_a_description(capsys: pytest.CaptureFixture[str], command: str) -> None:
    assert main([command, "--help"]) == 0
    out = capsys.readouterr().out
    sentence = " ".join(out.split("\n\n")[1].split())
    told = COMMANDS[command]
    assert sentence == f"{told[0].upper()}{told[1:]}."  # TCP and Passo stay what they are
    # What stands alone in its row is told of in the next one, deep to the right.
    assert re.findall(r"^  -(?!.*\S {2,}\S).*\n(?! {10})", out, re.MULTILINE) == []


def test_help_imports_nothing_heavy() -> None:
    code = (
        "import sys; from passo.cli.main import main; main(['--help']); "
        "heavy = {'pydantic', 'rich', 'passo._core', 'numpy', 'tomllib'} & set(sys.modules); "
        "print(sorted(heavy), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr == "[]\n"
