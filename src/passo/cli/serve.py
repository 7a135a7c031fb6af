"""`passo serve`: a printer that hosts can drive."""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import sys

from passo.cli.machine_option import add_machine
from passo.errors import ExitStatus

_TCP = "127.0.0.1:2323"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo serve`."""
    add_machine(parser)
    parser.add_argument(
        "--clock",
        type=_clock,
        default=1.0,
        metavar="real|SCALE|fast",
        help="real (default); so many times as fast as real; or fast: print time passes as fast as "
        "it goes, but only while something waits for it",
    )
    consoles = parser.add_argument_group("consoles, each as often as you like")
    consoles.add_argument(
        "--serial", action="append", default=[], metavar="DEV[:BAUD]", help="a serial device"
    )
    consoles.add_argument(
        "--pty", action="append", default=[], metavar="PATH", help="a pseudo terminal, linked there"
    )
    consoles.add_argument(
        "--tcp",
        action="append",
        default=[],
        metavar="HOST:PORT",
        help=f"TCP; {_TCP} if no console is named",
    )
    consoles.add_argument(
        "--stdin", action="store_true", help="standard input and output, as a console"
    )
    parser.add_argument(
        "--sd",
        metavar="DIR|IMAGE|DEVICE",
        help="the SD card: a folder, a FAT32 image, or a block device",
    )
    parser.add_argument(
        "--state", metavar="DIR", help="where settings and the history of prints are kept"
    )
    parser.add_argument(
        "--tcp-clients", type=int, default=2, metavar="N", help="clients of a TCP console (2)"
    )


def _clock(text: str) -> float | None:
    """None for fast, else the scale of time."""
    if text == "fast":
        return None
    try:
        scale = 1.0 if text == "real" else float(text)
    except ValueError:
        scale = 0.0
    if not 0 < scale <= 1000:
        raise argparse.ArgumentTypeError(f"{text!r} is not real, fast, or a factor above 0")
    return scale


def run(arguments: argparse.Namespace) -> int:
    """Serves until interrupted."""
    from passo import config
    from passo.clock import new_loop

    machine = config.load(arguments.machine)
    scale = 1.0 if arguments.clock is None else arguments.clock
    with asyncio.Runner(loop_factory=lambda: new_loop(scale)) as runner:
        runner.run(_serve(arguments, machine))
    return ExitStatus.DONE


async def _serve(arguments: argparse.Namespace, machine: object) -> None:
    from passo.config.machine import MachineConfig
    from passo.console.printer_console import furnished
    from passo.console.session import Session
    from passo.console.wires import open_pty, open_serial, open_stdin, open_tcp

    assert isinstance(machine, MachineConfig)
    printer = furnished(
        machine, free=arguments.clock is None, card=arguments.sd, state=arguments.state
    )

    def opened(session: Session) -> None:
        session.say("start")
        session.say(f"echo:Passo, {machine.name}")
        if greeting := printer.greeting():
            session.say(greeting)

    opened_at: list[str] = []
    for path in arguments.pty:
        await open_pty(printer, path, opened)
        opened_at.append(f"pty {path}")
    for serial in arguments.serial:
        device, _, baud = serial.rpartition(":") if serial[-1:].isdigit() else (serial, "", "")
        if not device:
            device, baud = serial, ""
        await open_serial(printer, device, int(baud or 250000), opened)
        opened_at.append(f"serial {device}")
    silent = not (arguments.pty or arguments.serial or arguments.stdin)
    for address in arguments.tcp or ([_TCP] if silent else []):
        host, _, port = address.rpartition(":")
        await open_tcp(printer, host or "127.0.0.1", int(port), arguments.tcp_clients, opened)
        opened_at.append(f"tcp {address}")
    if arguments.stdin:
        await open_stdin(printer, opened)
    print(f"Serving {machine.name} on {', '.join(opened_at)}.", file=sys.stderr, flush=True)
    try:
        with contextlib.suppress(asyncio.CancelledError):
            await printer.run()
    finally:
        printer.close()
