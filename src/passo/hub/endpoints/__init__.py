"""The operations of the hub, one module for each subject. Each handler declares its row of the
table."""
