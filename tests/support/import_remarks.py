"""The remarks of an import, as lines."""

from __future__ import annotations

from passo.config.importing.draft import Draft, Fate


def remarks(draft: Draft, fate: Fate) -> list[str]:
    """The remarks of one kind: `place: what: text`."""
    return [f"{r.place}: {r.what}: {r.text}" for r in draft.remarks if r.fate == fate]
