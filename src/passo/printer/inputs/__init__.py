"""Inputs of a running printer: filament sensors, buttons, door and stop switches."""
