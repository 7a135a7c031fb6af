"""The streams of consoles: serial lines, ptys, TCP, standard input."""
