"""Converts machine files to configurations of other firmware, for a return to it and for
comparisons."""
