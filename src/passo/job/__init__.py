"""Jobs: the print or the plan of a whole program."""
