"""Images of firmware that clients order."""
