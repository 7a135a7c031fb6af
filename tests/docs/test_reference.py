"""The committed reference is what the table says; the README's code runs."""

from __future__ import annotations

import lzma
import re
from pathlib import Path

from passo.gcode.reference import reference

ROOT = Path(__file__).parents[2]


def test_the_reference_is_up_to_date():
    assert (ROOT / "docs/reference/gcode.md").read_text(encoding="utf-8") == reference()


def test_the_code_of_the_readme_runs(tmp_path, monkeypatch, capsys):
    (tmp_path / "build").mkdir()
    example = lzma.decompress((ROOT / "examples/demo.gcode.xz").read_bytes())
    (tmp_path / "build/demo.gcode").write_bytes(example)
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    exec(compile(code, "README.md", "exec"), {})
    limits, result = capsys.readouterr().out.splitlines()
    assert "'feedrate'" in limits
    assert "'x': 400, 'y': 14592, 'z': 60000" in result
