"""Studies: many files on many machines under many settings, on this computer or on a cluster."""
