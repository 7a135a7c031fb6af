"""Builds of firmware images for clients."""
