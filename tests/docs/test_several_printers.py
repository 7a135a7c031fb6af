"""The commands of the page about several printers start them beside each other."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import passo

PAGE = Path(__file__).parents[2] / "docs/how-to/run-several-printers.md"
NAMES = ("left", "middle", "right")
# Waits until each printer serves, asks them all, and ends them.
ROUND = """
{start}
for name in left middle right; do
  for _ in $(seq 600); do grep -q "^Serving" $name.log && break; sleep 0.1; done
done
{ask}
read -r over
kill %1 %2 %3
wait
"""


def test_three_printers_run_from_one_folder(tmp_path: Path):
    start, ask = re.findall(r"```sh\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    command = tmp_path / "passo"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m passo "$@"\n')
    command.chmod(0o755)
    script = ROUND.format(start=start, ask=ask).replace("passo ", f"{command} ")
    words = ["bash", "-mc", script]  # -m: jobs have numbers
    with subprocess.Popen(
        words, cwd=tmp_path, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as shell:
        assert shell.stdin is not None and shell.stdout is not None
        text = ""
        while text.count('"version"') < len(NAMES):
            piece = shell.stdout.read(1)
            assert piece, [(tmp_path / f"{name}.log").read_text() for name in NAMES]
            text += piece
        ids = set()
        for name in NAMES:
            summary = passo.Client(f"unix:{tmp_path / name}.sock").summary.get()
            assert (summary.name, summary.state) == (name, "idle")
            assert summary.id in text
            ids.add(summary.id)
        assert len(ids) == len(NAMES)
        shell.stdin.write("\n")
        shell.stdin.close()
        assert shell.wait() == 0
    assert list(tmp_path.glob("*.sock")) == []
