"""The address of a server on the command line."""

from __future__ import annotations

import argparse

_LOOPBACK = "127.0.0.1"
_AUTOMATIC = "auto"


def host_port(text: str) -> tuple[str, int]:
    """Host and port: `printer.local:2323`, `[::1]:2323`, `:2323` for this computer alone. The port
    `auto` is 0, any free one; `auto` alone is one of this computer alone."""
    host, colon, port = text.rpartition(":")
    host = host.removeprefix("[").removesuffix("]") or _LOOPBACK
    if port == _AUTOMATIC:
        return host, 0
    if not (colon and port.isascii() and port.isdigit() and int(port) < 65536):
        raise argparse.ArgumentTypeError(
            f"{text!r} is not HOST:PORT, with a port below 65536 or auto"
        )
    return host, int(port)
