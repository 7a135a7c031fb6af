"""Prints of a served printer: from the card or a host."""
