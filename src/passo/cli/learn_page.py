"""The page of the course, on a simulated printer of this computer."""

from __future__ import annotations

import asyncio
import os
import webbrowser

from passo.errors import CommandError, InputError

_MACHINE = "i3-probe"
_HOST, _PORT = "127.0.0.1", 4000
_SCREENS = ("DISPLAY", "WAYLAND_DISPLAY")


def serve_page() -> None:
    """Serves the page until Ctrl-C or SIGTERM; opens it, if this computer has a screen. Raises
    CommandError if Passo is installed without its web interface."""
    from passo.library.printer import run

    try:
        run(_serve())
    except KeyboardInterrupt:
        pass
    except ImportError as error:
        name = error.name or "a package"
        raise CommandError.of("console.not-installed", axis="the page", value=name) from None


async def _serve() -> None:
    from passo.library.printer import Printer

    async with Printer(_MACHINE) as printer:
        try:
            address = printer.open_http(_HOST, _PORT)
        except InputError:  # another program has this port
            address = printer.open_http(_HOST)
        address += "/#/learn"
        print(f"The course is at {address} (Ctrl-C ends it).", flush=True)
        if any(os.environ.get(name) for name in _SCREENS):
            await asyncio.to_thread(webbrowser.open, address)
        await asyncio.Event().wait()
