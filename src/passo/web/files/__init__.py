"""Reading and writing files of the card for clients of the web."""
