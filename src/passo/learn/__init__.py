"""Explanations of single lines and of whole prints."""
