"""Geometries: from the nozzle's X, Y, Z to the motors' positions and back, one file each."""
