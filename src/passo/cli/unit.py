"""`passo unit MACHINE`: prints the systemd unit that starts a printer."""

from __future__ import annotations

import argparse
import getpass
import importlib
import sys
from pathlib import Path

from passo.errors import ExitStatus, InputError

_UNIT = """\
# Made by `passo unit`. Put it at /etc/systemd/system/passo.service.
[Unit]
Description=Passo: {name}
After=network.target
# Both need the ports of the boards: starting one stops the other.
Conflicts=klipper.service

[Service]
User={user}
ExecStart={command}
Restart=on-failure
RestartSec=5
SuccessExitStatus=130
# A wrong machine file stays wrong: see `systemctl status passo`.
RestartPreventExitStatus=2 3

[Install]
WantedBy=multi-user.target
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments of `passo unit`."""
    parser.add_argument("machine", metavar="MACHINE", help="a machine file, or a shipped machine")
    parser.add_argument(
        "--data",
        metavar="FOLDER",
        default="~/printer_data",
        help="the folder that Moonraker has: ~/printer_data",
    )
    parser.add_argument("--user", metavar="NAME", help="the user of the service: you")


def run(arguments: argparse.Namespace) -> int:
    """Prints the unit. Raises ConfigError for a machine file with errors, and InputError if Passo
    is installed without the part that Moonraker needs."""
    from passo import config

    machine = config.load(arguments.machine)
    try:
        importlib.import_module("msgspec")
    except ImportError as error:
        raise InputError.of(
            "console.not-installed", axis="Klipper's socket", value=error.name or "msgspec"
        ) from None
    path, data = Path(arguments.machine), Path(arguments.data).expanduser().absolute()
    words = [
        *(sys.executable, "-m", "passo", "serve"),
        *("--machine", str(path.absolute()) if path.exists() else arguments.machine),
        *("--sd", str(data / "gcodes")),
        *("--klippy-socket", str(data / "comms" / "klippy.sock")),
        *("--state", str(data / "passo")),
    ]
    user = arguments.user or getpass.getuser()
    command = " ".join(map(_quoted, words))
    print(_UNIT.format(name=machine.name, user=user, command=command), end="")
    return ExitStatus.DONE


def _quoted(word: str) -> str:
    """A word of a command, quoted for systemd (systemd.service(5), Command lines)."""
    plain = word.replace("%", "%%").replace("$", "$$")
    if not any(sign in plain for sign in " \t\"'\\;"):
        return plain
    return '"' + plain.replace("\\", "\\\\").replace('"', '\\"') + '"'
