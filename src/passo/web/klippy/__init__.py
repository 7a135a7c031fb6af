"""Klipper's API socket: Moonraker, and with it Mainsail, Fluidd and KlipperScreen, connect here."""
