"""Errors of stored settings and of the folder of --state."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, bad_input

SETTINGS: Mapping[str, Entry] = {
    "settings.nowhere": bad_input(
        "settings", "there is no place to store settings", "Start with --state DIRECTORY"
    ),
    "settings.none": bad_input("settings", "no settings are stored", "Store them first (M500)"),
    "settings.unreadable": bad_input(
        "settings",
        "the stored settings are not used: {value}",
        "Store new ones (M500). Until then the values of the machine file apply",
    ),
    "settings.unwritable": bad_input(
        "settings",
        "the settings were not stored: {value}",
        "Check the directory, its permissions and the free space on the disk",
    ),
    "state.busy": bad_input(
        "printer",
        "another printer keeps its prints and settings in this folder: {value}",
        "Stop the other printer, or give each printer its own folder (--state)",
    ),
    "option.unknown": bad_input(
        "settings",
        "UnknownOption: there is no option {value}",
        "Name one as APrinter does, such as XStepsPerUnit",
    ),
}
