"""RepRapFirmware's config.g as a machine file."""

from passo.config.importing.rrf.imported import imported

__all__ = ["imported"]
