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


def parsed(text: str) -> RawConfigParser:
    unit = RawConfigParser()
    unit.optionxform = str  # type: ignore[assignment, method-assign]
    unit.read_string(text)
    return unit


def started(command: str) -> dict[str, object]:
    """The options with which a command of a unit starts the printer."""
    words = shlex.split(command)
    assert words[:4] == [sys.executable, "-m", "passo", "serve"]
    parser = argparse.ArgumentParser()
    serve.add_arguments(parser)
    return vars(parser.parse_args(words[4:]))


def test_unit_starts_the_printer_in_the_folders_of_moonraker(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "my 100% printer.toml"
    path.write_text(config.shipped_text("voron-0"), encoding="utf-8")
    words = ["unit", str(path), "--data", str(tmp_path / "data"), "--user", "pi"]
    assert main(words) == 0
    unit = parsed(capsys.readouterr().out)
    assert unit["Unit"]["Description"] == "Passo: voron-0"
    assert unit["Unit"]["Conflicts"] == "klipper.service"
    assert unit["Service"]["User"] == "pi"
    options = started(unit["Service"]["ExecStart"].replace("%%", "%"))
    assert options["machine"] == str(path)
    assert options["sd"] == str(tmp_path / "data" / "gcodes")
    assert options["klippy_socket"] == str(tmp_path / "data" / "comms" / "klippy.sock")


def test_template_gives_each_printer_its_own_folders_and_socket(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["unit", "--template", "--printers", "/etc/my 100% $", "--user", "passo"]) == 0
    unit = parsed(capsys.readouterr().out)
    service = unit["Service"]
    assert "Conflicts" not in unit["Unit"]
    command = service["ExecStart"].replace("%%", "%").replace("$$", "$").replace("%i", "left")
    more = command.replace("$OPTIONS", "--http 0.0.0.0:4001 --announce")
    for words, address in (
        (command.removesuffix("$OPTIONS"), Path("/run/passo/left.sock")),
        (more, ("0.0.0.0", 4001)),
    ):
        options = started(words)
        assert options["machine"] == "/etc/my 100% $/left.toml"
        assert (options["sd"], options["state"]) == (
            "/var/lib/passo/left/card",
            "/var/lib/passo/left",
        )
        assert (options["tcp"], options["http"]) == (["none"], address)
    assert service["EnvironmentFile"] == "-/etc/my 100%% $/%i.env"
    assert service["StateDirectory"].split() == ["passo/%i", "passo/%i/card"]
    assert (service["RuntimeDirectory"], service["RuntimeDirectoryPreserve"]) == ("passo", "yes")
    assert (service["Slice"], service["User"]) == ("passo.slice", "passo")
    assert {"MemoryMax", "CPUWeight", "OOMScoreAdjust"} <= set(service)
    assert main(["unit", "i3"]) == 0
    alone = parsed(capsys.readouterr().out)["Service"]
    for key in ("Restart", "RestartSec", "SuccessExitStatus", "RestartPreventExitStatus"):
        assert service[key] == alone[key]


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
