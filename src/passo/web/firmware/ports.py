"""The ports of this computer through which a board may be flashed."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from msgspec import Struct

from passo.config.machine import MachineConfig

# USB adapters, boards with a USB port of their own, and the UART of a Raspberry Pi.
_DEVICES = ("ttyUSB*", "ttyACM*", "ttyAMA*")
_NAMES = Path("/dev/serial/by-id")
_DRIVES = ("/media/*/*", "/run/media/*/*")
_DRIVE_MARK = "INFO_UF2.TXT"  # of a chip that waits for its image


class Port(Struct):
    """A serial port, or the folder of a chip's drive to which the image is copied. `name` is the
    name of the device in the operating system, or empty. `used` is True if this printer uses the
    port."""

    path: str
    name: str
    used: bool


def ports(machine: MachineConfig, places: Sequence[str]) -> list[Port]:
    """The ports that there are now. `places` are the ports of the consoles, in the form of the
    bridge."""
    used = {os.path.realpath(device) for device in _used(machine, places)}
    names = {os.path.realpath(path): path.name for path in _in(_NAMES, "*")}
    devices = sorted(path for pattern in _DEVICES for path in _in(Path("/dev"), pattern))
    found = [Port(str(path), names.get(str(path), ""), str(path) in used) for path in devices]
    drives = (path for pattern in _DRIVES for path in _in(Path("/"), pattern[1:]))
    return found + [
        Port(str(path), path.name, False) for path in drives if (path / _DRIVE_MARK).is_file()
    ]


def _in(folder: Path, pattern: str) -> list[Path]:
    try:
        return sorted(folder.glob(pattern))
    except OSError:  # a folder of another user
        return []


def _used(machine: MachineConfig, places: Sequence[str]) -> Iterator[str]:
    for board in machine.all_boards.values():
        if board.link == "serial" and board.port:
            yield board.port
    for place in places:
        kind, _, device = place.partition(" ")
        if kind == "serial":
            yield device
