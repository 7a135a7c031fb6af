"""The version of Passo, apart from all else: what is built and what is served both name it."""

__version__ = "0.1.0"
