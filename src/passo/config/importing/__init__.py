"""Converts configurations of other firmwares to machine files, with a report on each value."""
