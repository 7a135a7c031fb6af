"""APrinter's configurations, as its editor exports them, as a machine file."""

from passo.config.importing.aprinter.imported import imported

__all__ = ["imported"]
