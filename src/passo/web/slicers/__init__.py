"""Interfaces of other print servers, to which slicers can upload."""
