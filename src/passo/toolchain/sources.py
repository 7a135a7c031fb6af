"""The sources of the firmware's core, for newer or older versions of the host protocol."""

from __future__ import annotations

from pathlib import Path


def core_sources(firmware: Path, *, older_hosts: bool = False) -> list[Path]:
    """The core's source files below the folder `firmware`, sorted by name. For older hosts, a file
    in `alternative/` replaces the file of the same name."""
    folders = ("core", "alternative") if older_hosts else ("core",)
    by_name = {path.name: path for folder in folders for path in firmware.glob(f"{folder}/*.c")}
    return [by_name[name] for name in sorted(by_name)]
