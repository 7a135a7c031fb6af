"""`passo hub`: serves a farm: many printers, one queue, one page."""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import signal
import sys
from ipaddress import ip_address
from pathlib import Path
from urllib.parse import urlsplit

from passo.cli.host_port import host_port
from passo.cli.log_file import LEVELS, LogFile
from passo.cli.main import endings
from passo.errors import ExitStatus, HubError

_HTTP = ("127.0.0.1", 4100)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo hub`."""
    parser.add_argument(
        "--state",
        required=True,
        metavar="DIR",
        help="where printers, files, the queue, the history and accounts are kept",
    )
    parser.add_argument(
        "--http",
        type=host_port,
        default=_HTTP,
        metavar="HOST:PORT",
        help=f"where the page and the API are served; {_HTTP[0]}:{_HTTP[1]} by default",
    )
    parser.add_argument(
        "--http-name",
        action="append",
        default=[],
        metavar="NAME",
        help="a host name that the page is reached by, for example that of a proxy",
    )
    parser.add_argument(
        "--log",
        metavar="FILE",
        help="write what happens into this file; at 5 MB it is renamed to FILE.1, of which five "
        "are kept",
    )
    parser.add_argument(
        "--log-level", choices=LEVELS, default="info", metavar="LEVEL", help=", ".join(LEVELS)
    )


def run(arguments: argparse.Namespace) -> int:
    """Serves a farm until it is interrupted. Raises HubError if its folder cannot be used, or if
    `passo[hub]` is not installed; InputError if its address cannot be opened."""
    log = contextlib.nullcontext()
    if arguments.log is not None:
        try:
            log = LogFile(arguments.log, "text", arguments.log_level)
        except OSError as error:
            reason = error.strerror or str(error)
            print(f"passo hub: error: --log {arguments.log}: {reason}", file=sys.stderr)
            return ExitStatus.USAGE
    with log:
        asyncio.run(_serve(arguments))
    return ExitStatus.DONE


async def _serve(arguments: argparse.Namespace) -> None:
    try:
        from passo.hub.serve import served
    except ImportError as error:
        raise HubError.of("hub.package", value=error.name or "a package") from None
    ended = asyncio.Event()
    for number in (signal.SIGINT, *endings()):
        asyncio.get_running_loop().add_signal_handler(number, ended.set)
    state = Path(arguments.state)
    host, port = arguments.http
    async with served(host, port, state, names=arguments.http_name) as hub:
        print(f"Serving the farm on {hub.url}.", file=sys.stderr, flush=True)
        if hub.code:
            print(_first_account(hub.url, hub.code), file=sys.stderr, flush=True)
        await ended.wait()


def _first_account(url: str, code: str) -> str:
    """How the hub gets its first account."""
    if ip_address(urlsplit(url).hostname or "").is_loopback:
        text = "has no administrator yet: programs of this computer may do all"
        return f"The hub {text}. Open {url} to create one."
    return f"The hub needs an administrator: open {url} and enter the code {code}."
