"""Opens the web interface of `passo serve`, and Klipper's socket."""

from __future__ import annotations

import argparse
import sys
from ipaddress import ip_address
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from passo.cli.addresses import HTTP

if TYPE_CHECKING:
    from passo.cli.addresses import Host, Nowhere
    from passo.library.printer import Printer


def open_web(printer: Printer, arguments: argparse.Namespace) -> str:
    """Opens the web interface; returns its address, or an empty text without one. If the user did
    not ask for it, a failure is only reported, and the printer starts without it. Explains how it
    gets its first account."""
    from passo.errors import PassoError

    asked: Host | Path | Nowhere | None = arguments.http
    if asked == "none":
        return ""
    try:
        address = _opened(printer, arguments, asked or HTTP)
    except (PassoError, ImportError) as error:
        if (asked is not None or arguments.announce) and isinstance(error, PassoError):
            raise
        why = str(error)
        if isinstance(error, ImportError):
            extra = "mdns" if error.name == "zeroconf" else "web"
            why = f"{error.name} is not installed. Install passo[{extra}]."
        print(f"No web interface: {why}", file=sys.stderr)
        return ""
    if code := printer.one_time_code:
        _explain_first_account(address, code, kept=arguments.state is not None)
    return address


def _opened(printer: Printer, arguments: argparse.Namespace, asked: Host | Path) -> str:
    options = {"names": arguments.http_name, "log": arguments.log, "announce": arguments.announce}
    if isinstance(asked, Path):
        return printer.open_http(path=asked, **options)
    return printer.open_http(*asked, **options)


def _explain_first_account(address: str, code: str, *, kept: bool) -> None:
    """Explains how the web interface gets its first account."""
    host = urlsplit(address).hostname
    if host is None:
        text = "has no administrator yet: programs that may open its socket may do all"
    elif ip_address(host).is_loopback:
        text = "has no administrator yet: programs of this computer may do all"
        text = f"{text}. Open {address} to create one"
    else:
        text = f"needs an administrator: open it and enter the code {code}"
    lasts = "" if kept else ". Without --state accounts last until Passo ends"
    print(f"The web interface {text}{lasts}.", file=sys.stderr)


def open_klippy(printer: Printer, path: str, log_file: str | None) -> str:
    """Opens Klipper's socket. Raises InputError."""
    from passo.errors import InputError

    try:
        return printer.open_klippy(path, log_file=log_file)
    except ImportError as error:
        raise InputError.of(
            "console.not-installed", axis=f"socket {path}", value=error.name or "a package"
        ) from None
