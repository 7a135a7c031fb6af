"""The check of the options that a machine file keeps for macros."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from passo.config.findings import Finding, tables
from passo.config.klipper_options import OPTIONS, kind_of, option_of


def check_kept_options(data: Mapping[str, Any]) -> Iterator[Finding]:
    """Checks the table `klipper` of a machine file: names of sections and options, and values that
    macros can read."""
    for section, options in tables(data, "klipper"):
        if not section.strip():
            limit = "the name of a section of Klipper"
            yield Finding("config.value", ("klipper", section), section, limit)
            continue
        if kind_of(section) not in OPTIONS:
            continue  # of a plug-in
        for name, value in options.items():
            path = ("klipper", section, name)
            row = option_of(section, name)
            if row is None:
                yield Finding(
                    "config.value", path, name, f"an option that Klipper has in [{section}]"
                )
            elif isinstance(value, str) and not row.can_read(value):
                yield Finding("config.value", path, value, row.expected)
