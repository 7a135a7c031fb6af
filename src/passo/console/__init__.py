"""Who may talk to the printer: serial, pty, TCP, standard input."""
