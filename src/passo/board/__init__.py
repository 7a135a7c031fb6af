"""One board from the host's side: its dictionary, its configuration, and the connection to it."""
