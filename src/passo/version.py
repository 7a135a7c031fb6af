"""The version of Passo, in a file without imports, for the build and the server."""

__version__ = "0.1.0"
