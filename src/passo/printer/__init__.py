"""The printer: what its commands mean, and the board that carries them out."""
