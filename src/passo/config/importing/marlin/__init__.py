"""Marlin's Configuration.h, and that of MK4duo and StuFW, as a machine file."""

from passo.config.importing.marlin.imported import imported

__all__ = ["imported"]
