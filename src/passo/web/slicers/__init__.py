"""Interfaces of other printers' servers, which slicers know how to upload to."""
