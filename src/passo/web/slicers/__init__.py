"""Interfaces of other printers' servers, to which slicers can upload."""
