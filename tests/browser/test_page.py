"""The page: its units, and Chromium on `passo serve`. The tests themselves are in web-ui/, and
pictures of the page are in build/pictures after them."""

import lzma
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("project", ["unit", "browser"])
def test_page(project, tmp_path):
    example = tmp_path / "demo.gcode"
    example.write_bytes(lzma.decompress((ROOT / "examples" / "demo.gcode.xz").read_bytes()))
    environment = os.environ | {
        "PASSO_PYTHON": sys.executable,
        "PASSO_EXAMPLE": str(example),
        "NO_COLOR": "1",
    }
    command = [sys.executable, ROOT / "tools" / "build_page.py", "--test", project]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
