"""Errors of machine files."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus


def _config(says: str, action: str) -> Entry:
    return Entry("config", says, action, ExitStatus.BAD_CONFIG)


CONFIG: Mapping[str, Entry] = {
    "config.unknown-machine": _config(
        "there is no machine called {value!r}",
        "Name a shipped machine (see `passo machines`) or the path of a TOML file",
    ),
    "config.unreadable": _config("cannot be read: {value}", "Check the path and its permissions"),
    "config.encoding": _config("is not UTF-8 text: {value}", "Save the file as UTF-8"),
    "config.syntax": _config("is not valid TOML: {value}", "Correct the syntax at this place"),
    "config.unknown-key": _config("{key} is not a known key", "Remove it or correct its name"),
    "config.missing-key": _config("{key} is missing: expected {limit}", "Add the key"),
    "config.value": _config("{key} is {value!r}: expected {limit}", "Correct the value"),
    "config.conflict": _config("{key} is {value!r}: expected {limit}", "Change or remove it"),
    "config.home-side": _config(
        "{key} is {value!r}: expected {limit}",
        "Give the position at which the endstop triggers, or change the direction",
    ),
    "config.gain": _config(
        "{key} is {value!r}: {limit}",
        "Copy the gains of Klipper, Marlin or M303, or leave them out",
    ),
}
