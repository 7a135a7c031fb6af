"""`passo unit`: what systemd starts is what `passo serve` understands."""

import argparse
import shlex
import sys
from configparser import RawConfigParser
from pathlib import Path

import pytest

from passo import config
from passo.cli import serve
from passo.cli.main import main


def test_unit_starts_the_printer_in_the_folders_of_moonraker(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "my 100% printer.toml"
    path.write_text(config.shipped_text("voron-0"), encoding="utf-8")
    words = ["unit", str(path), "--data", str(tmp_path / "data"), "--user", "pi"]
    assert main(words) == 0
    unit = RawConfigParser()
    unit.optionxform = str  # type: ignore[assignment, method-assign]
    unit.read_string(capsys.readouterr().out)
    assert unit["Unit"]["Description"] == "Passo: voron-0"
    assert unit["Unit"]["Conflicts"] == "klipper.service"
    assert unit["Service"]["User"] == "pi"
    started = shlex.split(unit["Service"]["ExecStart"].replace("%%", "%"))
    assert started[:4] == [sys.executable, "-m", "passo", "serve"]
    parser = argparse.ArgumentParser()
    serve.add_arguments(parser)
    options = vars(parser.parse_args(started[4:]))
    assert options["machine"] == str(path)
    assert options["sd"] == str(tmp_path / "data" / "gcodes")
    assert options["klippy_socket"] == str(tmp_path / "data" / "comms" / "klippy.sock")


def test_a_machine_with_errors_has_no_unit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("name = 1\n", encoding="utf-8")
    assert main(["unit", str(path)]) == 3
    assert "[Service]" not in capsys.readouterr().out


def test_a_unit_that_moonraker_cannot_use_is_not_made(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "msgspec", None)
    assert main(["unit", "voron-0"]) == 2
    printed = capsys.readouterr()
    assert "Klipper's socket needs msgspec, which is not installed" in printed.err
    assert printed.out == ""
