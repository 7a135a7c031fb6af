"""Reads and changes the machine file for clients."""
