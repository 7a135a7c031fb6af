"""The reference page of the study file: each table with its keys."""

from __future__ import annotations

from tools.references.machine_file import rows_of, tables_of

from passo.study.study_file import Study
from passo.study.work import STATUSES

_HEAD = """# Keys of the study file

Made from the models in `src/passo/study/study_file.py` by `tools/references/study_file.py`. [How to
study settings](../how-to/study-settings.md) has examples. An unknown key is an error.
"""
_ROWS = """## The results

A row of `results.csv` is one file on one machine under one setting. `id` is the hash of all that
the row depends on: the content of the file, the values of the machine, the options, and the
program. Rows with the same id are computed once.

{statuses}

Columns that begin with `set` are the keys of the setting. Times are in s, lengths in mm, unless the
name ends in another unit.
"""


def reference() -> str:
    """The page, in Markdown."""
    parts = [_HEAD]
    for heading, text, keys in tables_of(Study):
        parts.append(f"## {heading}\n\n{text}\n\n{rows_of(keys)}\n")
    lines = [f"| `{status}` | {what} | {action} |" for status, (what, action) in STATUSES.items()]
    table = "\n".join(["| status | meaning | what to do |\n|---|---|---|", *lines])
    return "\n".join([*parts, _ROWS.format(statuses=table)])
