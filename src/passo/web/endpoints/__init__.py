"""The operations for clients, one module for each subject. Each handler declares its row of the
table."""
