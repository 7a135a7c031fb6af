"""What follows a failed board or a lost link."""
