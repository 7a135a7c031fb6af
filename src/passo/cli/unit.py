"""`passo unit MACHINE` and `passo unit --template`: print the systemd unit that starts a printer,
or each of several printers."""

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
{restart}
[Install]
WantedBy=multi-user.target
"""

_TEMPLATE = """\
# Made by `passo unit --template`. Put it at /etc/systemd/system/passo@.service.
# `systemctl enable --now passo@i3` starts the printer of {folder}/i3.toml.
[Unit]
Description=Passo: printer %i
After=network.target

[Service]
User={user}
# More options for one printer, such as OPTIONS=--http 0.0.0.0:4001 --announce
EnvironmentFile=-{folder}/%i.env
ExecStart={command} $OPTIONS
{restart}# /var/lib/passo/%i has the state of the printer, its folder `card` the files to print.
StateDirectory=passo/%i passo/%i/card
StateDirectoryMode=0750
# /run/passo has the sockets of all printers: it stays while another printer runs.
RuntimeDirectory=passo
RuntimeDirectoryMode=0755
RuntimeDirectoryPreserve=yes
# All printers together: `systemctl status passo.slice`.
Slice=passo.slice
# One printer needs 70 MB, and 60 MB more while it plans a file.
MemoryMax=500M
# A printer goes before other work, and is the last that the kernel ends if memory is short.
CPUWeight=500
OOMScoreAdjust=-500

[Install]
WantedBy=multi-user.target
"""

_RESTART = """\
Restart=on-failure
RestartSec=5
SuccessExitStatus=130
# A wrong machine file stays wrong: see `systemctl status {service}`.
RestartPreventExitStatus=2 3
"""
_PRINTERS = "/etc/passo/printers"
_NAME = "\0"  # stands for the name of the printer until the command is quoted
_STATE = f"/var/lib/passo/{_NAME}"
_SOCKET = f"/run/passo/{_NAME}.sock"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments of `passo unit`."""
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument(
        "machine", metavar="MACHINE", nargs="?", help="a machine file, or a shipped machine"
    )
    which.add_argument(
        "--template",
        action="store_true",
        help="passo@.service, which starts each printer of a folder of machine files",
    )
    parser.add_argument(
        "--printers",
        metavar="FOLDER",
        default=_PRINTERS,
        help=f"for --template: the folder of the machine files: {_PRINTERS}",
    )
    parser.add_argument(
        "--data",
        metavar="FOLDER",
        default="~/printer_data",
        help="for one printer: the folder that Moonraker has: ~/printer_data",
    )
    parser.add_argument("--user", metavar="NAME", help="the user of the service: you")


def run(arguments: argparse.Namespace) -> int:
    """Prints the unit. Raises ConfigError for a machine file with errors, and InputError if Passo
    is installed without the part that the unit needs."""
    user = arguments.user or getpass.getuser()
    if arguments.template:
        _require_web("the web interface")
        print(_template(Path(arguments.printers), user), end="")
        return ExitStatus.DONE
    from passo import config

    machine = config.load(arguments.machine)
    _require_web("Klipper's socket")
    path, data = Path(arguments.machine), Path(arguments.data).expanduser().absolute()
    command = _serve(
        *("--machine", str(path.absolute()) if path.exists() else arguments.machine),
        *("--sd", str(data / "gcodes")),
        *("--klippy-socket", str(data / "comms" / "klippy.sock")),
        *("--state", str(data / "passo")),
    )
    restart = _RESTART.format(service="passo")
    print(_UNIT.format(name=machine.name, user=user, command=command, restart=restart), end="")
    return ExitStatus.DONE


def _template(printers: Path, user: str) -> str:
    folder = printers.expanduser().absolute()
    command = _serve(
        *("--machine", str(folder / f"{_NAME}.toml"), "--sd", f"{_STATE}/card", "--state", _STATE),
        *("--tcp", "none", "--http", f"unix:{_SOCKET}"),
    ).replace(_NAME, "%i")
    place = str(folder).replace("%", "%%")
    restart = _RESTART.format(service="passo@NAME")
    return _TEMPLATE.format(folder=place, user=user, command=command, restart=restart)


def _serve(*options: str) -> str:
    """The command that serves a printer with these options."""
    return " ".join(map(_quoted, (sys.executable, "-m", "passo", "serve", *options)))


def _require_web(what: str) -> None:
    """Raises InputError if Passo is installed without its web interface."""
    try:
        importlib.import_module("msgspec")
    except ImportError as error:
        raise InputError.of(
            "console.not-installed", axis=what, value=error.name or "msgspec"
        ) from None


def _quoted(word: str) -> str:
    """A word of a command, quoted for systemd (systemd.service(5), Command lines)."""
    plain = word.replace("%", "%%").replace("$", "$$")
    if not any(sign in plain for sign in " \t\"'\\;"):
        return plain
    return '"' + plain.replace("\\", "\\\\").replace('"', '\\"') + '"'
