"""Lessons, one in each file, called LESSON."""
