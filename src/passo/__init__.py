"""Passo: a 3-D printer control system. G-code in, exact step times out."""

__version__ = "0.1.0"
