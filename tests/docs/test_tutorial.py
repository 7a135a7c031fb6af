"""What the pages of docs/tutorial/ show is what their commands print, one after the other."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

PAGES = Path(__file__).parents[2] / "docs" / "tutorial"
BLOCK = re.compile(
    r"`([\w.]+)`[^`]*?```(?:gcode|python|toml)\n(.*?)```|```console\n(.*?)```", re.DOTALL
)


def commands(block: str) -> list[tuple[str, list[str]]]:
    """Each command of a block with the lines shown behind it."""
    found: list[tuple[str, list[str]]] = []
    for line in block.splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        else:
            found[-1][1].append(line)
    return found


@pytest.mark.parametrize(
    ("page", "written", "lines_shown"),
    [
        ("one-line.md", ["first.gcode", "first.py", "talk.gcode"], 29),
        ("ringing.md", ["spring.toml", "corner.gcode", "rows.py", "compare.py"], 8),
    ],
)
def test_each_command_prints_what_is_shown(
    page: str, written: list[str], lines_shown: int, tmp_path: Path
) -> None:
    for word, module in (("passo", "-m passo"), ("python", "")):
        script = tmp_path / word
        script.write_text(f'#!/bin/sh\nexec "{sys.executable}" {module} "$@"\n')
        script.chmod(0o755)
    environment = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}", "PYTHONUTF8": "1"}
    files: list[str] = []
    shown = 0
    for name, text, block in BLOCK.findall((PAGES / page).read_text(encoding="utf-8")):
        if text:
            (tmp_path / name).write_text(text, encoding="utf-8")
            files.append(name)
        for command, lines in commands(block):
            told = subprocess.run(
                command,
                shell=True,
                cwd=tmp_path,
                env=environment,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
            )
            assert told.returncode == 0, (command, told.stdout)
            printed = iter(told.stdout.splitlines())
            for line in lines:
                assert line in printed, (command, line, told.stdout)
                shown += 1
    assert files == written
    assert shown == lines_shown
