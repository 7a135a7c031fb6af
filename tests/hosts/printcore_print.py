"""Prints a file with Printrun's printcore, in the hosts' own environment.

Usage: printcore_print.py PORT FILE [--pause-at LINE] [--cancel-at LINE] [--vanish-at LINE]
Writes what it has seen as JSON. PORT is a pty or HOST:PORT.
"""

import argparse
import json
import os
import time
from pathlib import Path

from printrun import gcoder, printcore


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("port")
    parser.add_argument("file")
    for event in ("pause", "cancel", "vanish"):
        parser.add_argument(f"--{event}-at", type=int, default=1 << 30)
    arguments = parser.parse_args()
    seen = {"resends": 0, "heard": []}

    def heard(line: str) -> None:
        if line.lower().startswith(("resend", "rs")):
            seen["resends"] += 1
        elif not line.startswith(("ok", "wait", "echo:busy")):
            seen["heard"].append(line.strip())

    core = printcore.printcore()
    core.recvcb = heard
    core.connect(arguments.port, 250000)
    wait(lambda: core.online)
    program = gcoder.LightGCode(Path(arguments.file).read_text(encoding="ascii").splitlines())
    core.startprint(program)

    def reached(line: int) -> bool:
        return core.queueindex >= line or not core.printing

    event = min(arguments.pause_at, arguments.cancel_at, arguments.vanish_at)
    wait(lambda: reached(event))
    if core.printing and event == arguments.vanish_at:
        os._exit(0)
    elif core.printing and event == arguments.cancel_at:
        core.cancelprint()
        seen["cancelled_at"] = core.queueindex
    elif core.printing and event == arguments.pause_at:
        core.pause()
        seen["paused_at"] = core.queueindex
        time.sleep(0.5)
        seen["sent_in_pause"] = core.queueindex - seen["paused_at"]
        core.resume()
    wait(lambda: not core.printing)
    # The thread that printed starts the one that idles; disconnect() trips over it in between.
    wait(lambda: core.send_thread is not None and core.send_thread.is_alive())
    seen["online"] = core.online
    core.disconnect()
    print(json.dumps(seen))


def wait(condition, within_s: float = 60.0) -> None:
    end = time.monotonic() + within_s
    while not condition():
        if time.monotonic() > end:
            raise SystemExit("printcore waits for ever")
        time.sleep(0.01)


main()
