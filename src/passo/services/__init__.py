"""What consoles, the web and programs use of a printer."""
