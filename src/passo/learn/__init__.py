"""Explanations: one line, one print, for people who want to see how it works."""
