"""Jobs: whole programs, from the file to the result."""
