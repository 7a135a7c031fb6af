"""The shape of the bed and the geometry of the machine, from probed heights: arithmetic alone."""
