"""Imports every configuration of a folder, and prints a table: what became a valid machine file,
what was left out or is to decide, and why the others were refused."""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path

from passo import config
from passo.cli.tables import columns
from passo.config.importing.formats import imported
from passo.errors import ConfigError


def main() -> int:
    """Prints the table. Files that are meant to be included are left out."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    rows = [("FILE", "IMPORTED", "LEFT OUT", "TO DECIDE", "BOARD", "REASON")]
    dropped = Counter[str]()
    good = total = 0
    files = sorted({*folder.glob("printer-*.cfg"), *folder.glob("example-*.cfg")})
    others = [*folder.glob("*Configuration.h"), *folder.glob("*.json")]
    for path in [*(files or sorted(folder.glob("*.cfg"))), *sorted(others)]:
        total += 1
        try:
            draft = imported(path)
            machine = config.load_text(draft.text(path.name), path.name)
        except ConfigError as error:
            rows.append((path.name, "no", "", "", "", error.problems[0].sentence))
            continue
        lost = [r.what for r in draft.remarks if r.fate == "dropped"]
        open_ones = [r for r in draft.remarks if r.fate == "decide"]
        dropped.update(what.split()[0].strip("[]") for what in lost)
        good += 1
        counts = str(len(lost)), str(len(open_ones))
        rows.append((path.name, "yes", *counts, str(machine.board.base), ""))
    print(columns(rows))
    print(f"{good} of {total} become valid machine files.")
    print("Left out:", ", ".join(f"{name} {count}" for name, count in dropped.most_common(20)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
