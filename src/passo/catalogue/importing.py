"""Errors of configurations of other firmwares."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus


def _import(says: str, action: str) -> Entry:
    return Entry("import", says, action, ExitStatus.BAD_CONFIG)


IMPORT: Mapping[str, Entry] = {
    "import.line": _import(
        "{value!r} is not an option of a section, as `name: value`", "Correct the line"
    ),
    "import.include": _import(
        "the included files include each other: {value}", "Remove one of these includes"
    ),
    "import.missing": _import(
        "the included file {value!r} is not in {limit}", "Copy it there, or remove the include"
    ),
    "import.size": _import(
        "the files together have more than {limit} bytes", "Give the printer.cfg of one printer"
    ),
    "import.section": _import(
        "the section [{value}] is missing",
        "Give the whole configuration of a printer, not a part that others include",
    ),
    "import.kinematics": _import(
        "kinematics is {value!r}: Passo imports {limit}",
        "Write a machine file by hand, from a shipped machine of this geometry if there is one",
    ),
}
