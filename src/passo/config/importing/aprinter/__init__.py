"""Converts APrinter's configurations, as its editor exports them, to a machine file."""

from passo.config.importing.aprinter.imported import imported

__all__ = ["imported"]
