"""The operations for clients, one subject a module: each handler with its row of the table."""
