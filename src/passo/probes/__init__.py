"""Probes: the keys of each kind in the machine file, and how it is deployed and stowed."""
