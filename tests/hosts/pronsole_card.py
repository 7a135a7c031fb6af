"""Uploads a file to the card with Printrun's pronsole, lists it, and prints it from there; in the
hosts' own environment.

Usage: pronsole_card.py PORT FILE NAME, where PORT is a pty or HOST:PORT
"""

import os
import sys
import tempfile
import time
import types


class Window:
    """What pronsole's settings import of wxPython. They only use it under a window."""

    def __init__(self, *_, **__):
        pass

    def __getattr__(self, _):
        return Window()

    def __call__(self, *_, **__):
        return Window()

    def __rmul__(self, _):
        return 0


for name in ("wx", "wx.adv", "printrun.gui", "printrun.gui.widgets"):
    module = types.ModuleType(name)
    module.VERSION = (4, 2, 0)
    module.__path__ = []
    module.__getattr__ = lambda _: Window
    sys.modules[name] = module

home = tempfile.mkdtemp()
os.environ["HOME"] = home
from printrun import pronsole  # noqa: E402


def wait(condition, what, within_s=60.0):
    end = time.monotonic() + within_s
    while not condition():
        if time.monotonic() > end:
            print(f"pronsole waits for {what} for ever: {heard}", file=sys.stderr, flush=True)
            os._exit(1)  # it leaves threads behind
        time.sleep(0.05)


port, file, name = sys.argv[1:]
del sys.argv[1:]
heard = []
host = pronsole.pronsole()
host.rc_filename = f"{home}/pronsolerc"
host.recvcb = lambda line, take=host.recvcb: (heard.append(line.strip()), take(line))
host.p.recvcb = host.recvcb
host.onecmd(f"connect {port} 250000")
wait(lambda: host.p.online, "the printer")
host.onecmd(f"upload {file} {name}")
wait(lambda: "End file list" in heard, "the list")
host.onecmd(f"sdprint {host.sdfiles[0]}")
wait(lambda: "Done printing file" in heard, "the end")
host.p.disconnect()
os._exit(0)
