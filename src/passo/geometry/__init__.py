"""Geometries: each file converts X, Y, Z of the nozzle to motor positions and back."""
