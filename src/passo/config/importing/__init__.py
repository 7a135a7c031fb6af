"""Configurations of other firmwares become machine files, with a report of what became of each
value."""
