"""The streams that consoles talk through: serial lines, ptys, TCP, standard input."""
