"""The move queue of one machine, its homing and its positions."""
