"""An exported printer.cfg in an unchanged Kalico, which homes and moves without a board."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest
from tests.support.klipper_board import DICTIONARY

from passo import config
from passo.config.exporting.klipper import exported

MOVES = "G28\nG90\nG1 X20 Y20 Z12 F1200\nG1 X30 Y30\nM400\n"
_PIN = re.compile(r"pin: [!^~]*(?:(\w+):)?(\S+)$", re.MULTILINE)


def dictionary(clock_hz: int, pins: set[str]) -> str:
    """The data dictionary of Klipper's firmware on a chip with these pins."""
    told = json.loads(json.dumps(DICTIONARY))
    constants = {key: value for key, value in told["config"].items() if "RESERVE" not in key}
    told["config"] = constants | {"CLOCK_FREQ": clock_hz}
    told["enumerations"]["pin"] = {pin: number for number, pin in enumerate(sorted(pins))}
    return json.dumps(told)


# One of each geometry; drivers on UARTs and SPI, several motors of Z, probes, a hotend of an axis.
@pytest.mark.parametrize(
    "name", ["voron-2-4", "voron-0", "ender3-v2", "prusa-mk3s", "kossel", "four-pi"]
)
def test_kalico_runs_the_exported_file(hosts: Path, tmp_path: Path, name: str) -> None:
    machine = config.load(name)
    text = exported(machine).text("From a test.")
    (tmp_path / "printer.cfg").write_text(text, encoding="utf-8")
    (tmp_path / "moves.gcode").write_text(MOVES, encoding="utf-8")
    used = [(board, pin) for board, pin in _PIN.findall(text) if board != "probe"]
    words = ["-i", "moves.gcode", "-o", "sent"]
    for board, found in machine.all_boards.items():
        path = tmp_path / f"{board or 'mcu'}.dict"
        pins = {pin for its, pin in used if its == board}
        path.write_text(dictionary(found.clock_hz, pins), encoding="utf-8")
        words += ["-d", f"{board}={path}" if board else str(path)]
    run = subprocess.run(
        [hosts / "python", "-m", "klippy", "printer.cfg", *words],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr[-2000:]
    assert (tmp_path / "sent").stat().st_size > 5000  # the commands of the moves
