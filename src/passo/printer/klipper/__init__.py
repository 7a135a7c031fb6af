"""The printer's state as Klipper's status objects, for templates of macros and for clients of
Klipper's socket. Pure functions, one for each object; lengths in mm, speeds in mm/s, times in s."""
