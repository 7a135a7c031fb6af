"""Recovery after a failed board or a lost link."""
