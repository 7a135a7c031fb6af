"""G-code: the table of commands and their syntax."""
