"""The machine file, as clients read and change it."""
