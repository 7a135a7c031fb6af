"""Uploads a file to the card with Printrun's pronsole, lists it, and prints it from there; in the
hosts' own environment.

Usage: pronsole_card.py PTY FILE NAME
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

os.environ["HOME"] = tempfile.mkdtemp()
from printrun import pronsole  # noqa: E402


def wait(condition, within_s=60.0):
    end = time.monotonic() + within_s
    while not condition():
        if time.monotonic() > end:
            raise SystemExit("pronsole waits for ever")
        time.sleep(0.05)


port, file, name = sys.argv[1:]
del sys.argv[1:]
host = pronsole.pronsole()
host.onecmd(f"connect {port} 250000")
wait(lambda: host.p.online)
host.onecmd(f"upload {file} {name}")
host.onecmd("ls")
wait(lambda: name in host.sdfiles)
host.onecmd(f"sdprint {name}")
wait(lambda: host.sdprinting)


def done():
    host.p.send_now("M27")
    time.sleep(0.2)
    return not host.sdprinting


wait(done)
host.p.disconnect()
os._exit(0)
