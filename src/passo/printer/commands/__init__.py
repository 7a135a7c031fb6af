"""What the commands do: one subject a file."""
