"""Heat: sensors and what they tell."""
