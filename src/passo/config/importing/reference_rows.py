"""Tables of the reference pages on imports."""

from __future__ import annotations

from collections.abc import Mapping

from passo.config.importing.draft import Other


def table(title: str, columns: str, texts: Mapping[str, str]) -> str:
    """A section with a table of two columns, in the order of the names."""
    rows = "".join(f"| {name} | {texts[name]} |\n" for name in sorted(texts))
    return f"\n## {title}\n\n| {columns} |\n|---|---|\n{rows}"


def tables_of_others(what: str, others: Mapping[str, Other]) -> str:
    """The tables of the parts without a key: those that Passo has, and those that it does not."""
    kept, lost = (
        {name: other.text for name, other in others.items() if other.lost == gone}
        for gone in (False, True)
    )
    return table(
        f"{what.title()}s that Passo needs no key for", f"{what} | in Passo", kept
    ) + table(f"{what.title()}s that are not taken over", f"{what} | what that means", lost)
