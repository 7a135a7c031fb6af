"""What does not need the web does not load it."""

import subprocess
import sys

WEB = ("passo.web", "starlette", "uvicorn", "msgspec", "websockets", "sqlite3")
PROGRAM = f"""
import sys
from passo.cli.main import main
main(["print", sys.argv[1], "--machine", "i3"])
print("loaded", [name for name in sys.modules if name.startswith({WEB})])
"""


def test_print_from_the_command_line_loads_nothing_of_the_web(tmp_path):
    file = tmp_path / "part.gcode"
    file.write_text("G28\nG1 X10 F3000\n")
    command = [sys.executable, "-c", PROGRAM, str(file)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.stdout.splitlines()[-1] == "loaded []", done.stderr
