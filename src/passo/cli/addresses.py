"""The options of `passo serve` with the addresses of its consoles and of its web interface."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Literal, TypeAlias

from passo.cli.host_port import host_port

Host: TypeAlias = tuple[str, int]  # host and port; port 0 is any free one
Nowhere: TypeAlias = Literal["none"]

TCP: Host = ("127.0.0.1", 2323)
HTTP: Host = ("127.0.0.1", 4000)
_BAUD = 250_000
_UNIX = "unix:"


def add_consoles(parser: argparse.ArgumentParser) -> None:
    """Declares the options of consoles."""
    consoles = parser.add_argument_group("consoles, each as often as you like")
    consoles.add_argument(
        "--serial",
        action="append",
        type=_serial,
        default=[],
        metavar="DEV[:BAUD]",
        help=f"a serial device, at any rate; {_BAUD} if none is given",
    )
    consoles.add_argument(
        "--pty",
        action="append",
        type=filled,
        default=[],
        metavar="PATH",
        help="a pseudo terminal, linked there",
    )
    consoles.add_argument(
        "--tcp",
        action="append",
        type=_tcp,
        default=[],
        metavar="HOST:PORT|auto|none",
        help=f"TCP; {TCP[0]}:{TCP[1]} if no console is named; with auto, also as PORT, any free"
        " port, which is printed",
    )
    consoles.add_argument(
        "--stdin", action="store_true", help="standard input and output, as a console"
    )


def add_web(parser: argparse.ArgumentParser) -> None:
    """Declares the options of the web interface."""
    parser.add_argument(
        "--http",
        type=_http,
        metavar="HOST:PORT|auto|unix:PATH|none",
        help=f"the web interface; {HTTP[0]}:{HTTP[1]} by default; with auto, also as PORT, any free"
        " port, which is printed; with unix:PATH, a Unix socket for its user and group",
    )
    parser.add_argument(
        "--http-name",
        action="append",
        default=[],
        metavar="NAME",
        help="a host name that the web interface is reached by, for example that of a proxy",
    )
    parser.add_argument(
        "--announce",
        action="store_true",
        help="announce the web interface in the local network, so that slicers and hubs list it;"
        " needs passo[mdns]",
    )
    parser.add_argument(
        "--klippy-socket",
        type=filled,
        metavar="PATH",
        help="Klipper's API for Moonraker, on a Unix socket there; needs --sd with a folder",
    )


def filled(text: str) -> str:
    """A path that is not empty."""
    if not text:
        raise argparse.ArgumentTypeError("the path is empty")
    return text


def _tcp(text: str) -> Host | Nowhere:
    """Like `host_port`, or `none`."""
    return "none" if text == "none" else host_port(text)


def _http(text: str) -> Host | Path | Nowhere:
    """Like `_tcp`, or the path of a Unix socket."""
    if not text.startswith(_UNIX):
        return _tcp(text)
    return Path(filled(text.removeprefix(_UNIX)))


def _serial(text: str) -> tuple[str, int]:
    """Device and rate in bits/s. The name of a device may contain colons."""
    device, _, baud = text.rpartition(":")
    if not device or Path(text).exists() or not (baud.isascii() and baud.isdigit()):
        return text, _BAUD
    if not 0 < int(baud) < 1 << 31:
        raise argparse.ArgumentTypeError(f"{text!r}: {baud} is no rate")
    return device, int(baud)
