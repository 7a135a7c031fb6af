"""Passo: a 3-D printer control system. G-code in, exact step times out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from passo.machine import Machine

__version__ = "0.1.0"
__all__ = ["Machine", "__version__"]


def __getattr__(name: str) -> Any:
    """`passo.Machine`, loaded at first use so that the command line starts at once."""
    if name == "Machine":
        from passo.machine import Machine

        return Machine
    raise AttributeError(f"module 'passo' has no attribute {name!r}")
