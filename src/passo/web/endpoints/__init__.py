"""What clients may ask for, one subject a module: each handler with its row of the table."""
