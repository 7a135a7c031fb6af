"""Errors of configurations of other firmwares."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus


def _import(says: str, action: str) -> Entry:
    return Entry("import", says, action, ExitStatus.BAD_CONFIG)


IMPORT: Mapping[str, Entry] = {
    "import.line": _import(
        "{value!r} is not an option of the form `name: value`", "Correct the line"
    ),
    "import.include": _import(
        "the included files include each other: {value}", "Remove one of these includes"
    ),
    "import.missing": _import(
        "the included file {value!r} is not in {limit}",
        "Copy it there",
    ),
    "import.size": _import(
        "the files together have more than {limit} bytes", "Give the configuration of one printer"
    ),
    "import.files": _import(
        "more than {limit} files are included", "Give the configuration of one printer"
    ),
    "import.section": _import(
        "the section [{value}] is missing",
        "Give the whole configuration of a printer, not a part that others include",
    ),
    "import.define": _import(
        "{value} is not defined",
        "Give Configuration.h of one printer; Configuration_adv.h is read from the same folder",
    ),
    "import.board": _import(
        "the board is {value!r}: Passo has no file of this board; it knows {limit}",
        "Name a board with the same wiring: --board NAME; `passo firmware list` lists the boards",
    ),
    "import.no-board": _import(
        "there is no board {value!r}", "`passo firmware list` lists the boards"
    ),
    "import.endif": _import("{value} has no #if or #endif of its own", "Correct the line"),
    "import.nest": _import(
        "more than {limit} conditions are nested", "Remove conditions around this line"
    ),
    "import.long-line": _import(
        "the line has more than {limit} characters", "Shorten the line, or divide it"
    ),
    "export.kinematics": Entry(
        "import",
        "geometry.kind is {value!r}: Passo exports {limit}",
        "Write the configuration by hand",
        ExitStatus.BAD_CONFIG,
    ),
    "import.stored": _import(
        "a printer.cfg contains its stored values, in the block of SAVE_CONFIG",
        "Leave --stored out; it is for Marlin and APrinter",
    ),
    "import.kinematics": _import(
        "the kind of machine is {value!r}: Passo imports {limit}",
        "Write a machine file by hand, from a shipped machine of this geometry if there is one",
    ),
}
