"""Machine files become configurations of other firmwares, for the way back and for comparisons."""
