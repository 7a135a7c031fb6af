"""Watches: idle timeout, endstops, drivers, late commands, automatic fans."""
