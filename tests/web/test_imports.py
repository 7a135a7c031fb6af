"""What does not need a part of Passo does not load it."""

import subprocess
import sys

import pytest

WEB = ("passo.web", "starlette", "uvicorn", "msgspec", "websockets", "sqlite3")
PRINT = """
from passo.cli.main import main
main(["print", sys.argv[1], "--machine", "i3"])
"""
# what people and hosts do later, if at all
LATER = (
    "passo.card.fat",
    "passo.config.exporting.klipper",
    "passo.config.importing",
    "passo.hub",
    "passo.job.batch.simulated_print",
    "passo.learn.explain",
    "passo.study",
    "passo.toolchain",
    "passo.web.klippy",
    "passo.web.web_socket",
    *("dask", "difflib", "jinja2", "numpy", "rich", "tomlkit", "websockets", "zeroconf"),
)
IDLE = """
import passo
async def main():
    async with passo.Printer("i3") as printer:
        await printer.open_tcp()
        printer.open_http()
passo.run(main())
"""


@pytest.mark.parametrize(
    ("program", "unneeded"), [(PRINT, WEB), (IDLE, LATER)], ids=["print", "idle"]
)
def test_program_loads_only_what_it_needs(program, unneeded, tmp_path):
    file = tmp_path / "part.gcode"
    file.write_text("G28\nG1 X10 F3000\n")
    names = f"[name for name in sys.modules if name.startswith({unneeded})]"
    text = f"import sys\n{program}\nprint('loaded', {names})"
    command = [sys.executable, "-c", text, str(file)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.stdout.splitlines()[-1] == "loaded []", done.stderr
