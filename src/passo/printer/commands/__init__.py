"""The handlers of commands: one subject a file."""
