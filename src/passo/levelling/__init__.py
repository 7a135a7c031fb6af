"""Calculations only: the shape of the bed and the geometry of the machine from probed heights."""
