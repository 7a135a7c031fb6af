"""The folder of the state of a printer with simulated boards."""

from __future__ import annotations

import shutil
from pathlib import Path

_KEPT = ("meshes", "settings.json")  # no place and no journal of the real printer


def simulated_state(folder: Path) -> Path:
    """The folder inside that of the real printer, so that neither uses what the other stores. At
    its first use it gets copies of the meshes and settings of the real printer."""
    own = folder / "simulated"
    if own.exists():
        return own
    new = folder / "simulated.new"  # complete before it has its name
    shutil.rmtree(new, ignore_errors=True)
    new.mkdir(parents=True)
    for name in _KEPT:
        source = folder / name
        if source.is_dir():
            shutil.copytree(source, new / name)
        elif source.exists():
            shutil.copy2(source, new / name)
    new.rename(own)
    return own
