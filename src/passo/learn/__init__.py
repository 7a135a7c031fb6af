"""Explanations for users who want to see how a line or a print works."""
