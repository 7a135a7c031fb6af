"""The board as the host sees it: its dictionary, its configuration, a connection to it."""
