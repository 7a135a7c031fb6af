"""G-code: the table of all commands, and their syntax."""
