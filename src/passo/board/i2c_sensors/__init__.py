"""Sensor chips on I2C buses: how they are read, chip by chip, and what reads those of a board."""
