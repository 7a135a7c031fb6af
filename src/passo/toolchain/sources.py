"""The sources of the firmware's core, for newer or older versions of the host protocol."""

from __future__ import annotations

from collections.abc import Container
from pathlib import Path

# Modules that an AVR is too slow for: 3200 transfers of 9 bytes a second, by software.
TOO_FAST_FOR_AVR = ("accelerometer.c",)


def core_sources(
    firmware: Path, *, older_hosts: bool = False, without: Container[str] = ()
) -> list[Path]:
    """The core's source files below the folder `firmware`, sorted by name, except those named in
    `without`. For older hosts, a file in `alternative/` replaces the file of the same name."""
    folders = ("core", "alternative") if older_hosts else ("core",)
    by_name = {path.name: path for folder in folders for path in firmware.glob(f"{folder}/*.c")}
    return [by_name[name] for name in sorted(by_name) if name not in without]
