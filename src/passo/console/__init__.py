"""The consoles of the printer: serial, pty, TCP, standard input."""
