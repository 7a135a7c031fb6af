"""Imports every configuration of a folder, and prints a table: what became a machine file, what
passes its checks, what was left out, and why the others were refused."""

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
    rows = [("FILE", "IMPORTED", "CHECKED", "LEFT OUT", "REASON")]
    dropped = Counter[str]()
    good = total = 0
    files = sorted({*folder.glob("printer-*.cfg"), *folder.glob("example-*.cfg")})
    others = [*folder.glob("*Configuration.h"), *folder.glob("*.json")]
    for path in [*(files or sorted(folder.glob("*.cfg"))), *sorted(others)]:
        total += 1
        try:
            draft = imported(path)
        except ConfigError as error:
            rows.append((path.name, "no", "", "", error.problems[0].sentence))
            continue
        lost = [r.what for r in draft.remarks if r.fate == "dropped"]
        dropped.update(what.split()[0].strip("[]") for what in lost)
        try:
            config.load_text(draft.text(path.name), path.name)
        except ConfigError as error:
            rows.append((path.name, "yes", "no", str(len(lost)), error.problems[0].sentence))
            continue
        good += 1
        rows.append((path.name, "yes", "yes", str(len(lost)), ""))
    print(columns(rows))
    print(f"{good} of {total} import and pass their checks.")
    print("Left out:", ", ".join(f"{name} {count}" for name, count in dropped.most_common(20)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
