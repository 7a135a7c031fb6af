"""Klipper's printer.cfg, and that of Kalico, as a machine file."""

from passo.config.importing.klipper.imported import imported

__all__ = ["imported"]
