"""Builds the firmware: its declarations, its tables, its images."""
