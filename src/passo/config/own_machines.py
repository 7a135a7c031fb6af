"""Machine files that the page has saved from shipped machines, in the state folder of a printer."""

from __future__ import annotations

from pathlib import Path

from passo.config.load import machine_path

_FOLDER = "machines"


def own_path(source: str, state: Path | None) -> Path | None:
    """The path of the user's file in place of a shipped machine; None for other sources, and
    without a state folder."""
    if state is None or not source or machine_path(source) is not None:
        return None
    return state / _FOLDER / f"{source}.toml"


def own_or_shipped(source: str, state: Path | None) -> str:
    """The source to load: the user's file, if one was saved in place of this shipped machine."""
    path = own_path(source, state)
    return str(path) if path is not None and path.is_file() else source
