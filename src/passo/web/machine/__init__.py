"""The machine file for clients: read and change."""
