"""The language: which commands there are."""
