"""Every example of docs/reference/python.md prints what the page shows."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

import passo
from passo import events

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "python.md").read_text(encoding="utf-8")
PART = re.search(r"```gcode\n(.*?)```", PAGE, re.DOTALL)[1]
EXAMPLES = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", PAGE, re.DOTALL)


def example_output(folder, code):
    """What a script prints that runs in this folder."""
    (folder / "example.py").write_text(code, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-X", "utf8", "example.py"], cwd=folder, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


@pytest.mark.parametrize(("code", "output"), EXAMPLES, ids=range(len(EXAMPLES)))
def test_each_example_prints_what_is_shown(tmp_path, code, output):
    (tmp_path / "part.gcode").write_text(PART)
    assert example_output(tmp_path, code) == output


def test_no_example_is_left_out():
    assert len(EXAMPLES) == PAGE.count("```python\n") == 8


def test_every_event_and_call_is_named():
    names = [name for name, kind in vars(events).items() if isinstance(kind, type)]
    public = [name for name in vars(passo.Printer) if not name.startswith("_")]
    told = set(re.findall(r"\w+", PAGE))
    own = {"StateChanged", "JobEnded", *(n for n in names if n.endswith(("Changed", "Ended")))}
    assert own | {"Fault", "Message"} <= told
    assert {name for name in public if not name.startswith("open_stdin")} <= told | {"serve", "end"}
