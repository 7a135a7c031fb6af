"""Brings the sizes in docs/reference/firmware.md up to date: builds an image for each row of its
table "What fits", of the row's first board. Usage: .venv/bin/python tools/what_fits.py"""

import re
import tempfile
from pathlib import Path

from passo.toolchain.build import build
from passo.toolchain.targets import board_target

_PAGE = Path(__file__).parents[1] / "docs" / "reference" / "firmware.md"
_ROW = re.compile(
    r"^(\| ([\w.-]+)[\w., -]* \| \w+ \| )\d+( of \d+ \| )\d+( of \d+ \|)$", re.MULTILINE
)


def _built(row: re.Match[str]) -> str:
    with tempfile.TemporaryDirectory() as folder:
        _, about = build(board_target(row[2]), Path(folder))
    return f"{row[1]}{about.flash_bytes}{row[3]}{about.ram_bytes}{row[4]}"


_PAGE.write_text(_ROW.sub(_built, _PAGE.read_text(encoding="utf-8")), encoding="utf-8")
