"""`passo serve`: serves a printer to hosts and browsers."""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import logging
import sys
from collections.abc import AsyncGenerator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from passo.cli.addresses import TCP, add_consoles, add_web, filled
from passo.cli.clock import factor
from passo.cli.ending import Ending
from passo.cli.log_file import LEVELS, LogFile
from passo.cli.machine_option import add_machine, add_policy, add_skips, skips_of
from passo.cli.main import endings
from passo.cli.simulated_state import simulated_state
from passo.cli.web_interface import open_klippy, open_web
from passo.errors import ExitStatus

if TYPE_CHECKING:
    from passo.board.fault_injection import FaultOrder
    from passo.config.machine import MachineConfig
    from passo.library.printer import Printer

_log = logging.getLogger(__name__)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo serve`."""
    add_machine(parser)
    add_policy(parser)
    add_skips(parser)
    parser.add_argument(
        "--simulated",
        action="store_true",
        help="simulated boards in place of the real ones, to see this printer before it is"
        " connected. Its state is kept apart, in DIR/simulated of --state DIR, which begins with"
        " copies of the meshes and settings in DIR",
    )
    parser.add_argument(
        "--clock",
        type=_clock,
        default=1.0,
        metavar="real|SCALE|fast",
        help="real (default); so many times as fast as real; or fast: print time passes as fast as "
        "it goes, but only while something waits for it",
    )
    add_consoles(parser)
    add_web(parser)
    parser.add_argument(
        "--sd",
        metavar="DIR|IMAGE|DEVICE",
        help="the SD card: a folder, a FAT32 image, or a block device",
    )
    parser.add_argument(
        "--state",
        type=_state,
        metavar="DIR",
        help="where settings, the history of prints and reports of halts are kept",
    )
    parser.add_argument(
        "--log",
        type=filled,
        metavar="FILE",
        help="write what happens into this file; at 5 MB it is renamed to FILE.1, of which five "
        "are kept; reports of halts are beside it, if there is no --state",
    )
    parser.add_argument(
        "--log-level",
        choices=LEVELS,
        metavar="LEVEL",
        help=f"{', '.join(LEVELS)}: error has halts only, info (default) also what an operator "
        "wants to know, debug also each line of the consoles",
    )
    parser.add_argument(
        "--log-format",
        choices=("text", "json"),
        help="text (default), or one JSON object a line",
    )
    parser.add_argument(
        "--tcp-clients", type=_clients, default=2, metavar="N", help="clients of a TCP console (2)"
    )
    parser.add_argument(
        "--fault",
        action="append",
        default=[],
        metavar="PART=FAULT[@START][+DURATION]",
        help="give a part of the simulated printer a fault, at a print time and for a time (s or "
        "min): HEATER-sensor=open|short|noise|loose, HEATER-heater=on|off, "
        "ENDSTOP-endstop=triggered|open, cable=cut|noise, or none to end it; for example "
        "hotend-sensor=open@60s+30s. May be given several times; `--fault list` lists all",
    )
    parser.add_argument(
        "--advanced-ok",
        action="store_true",
        help="each ok tells the line's number, free moves and free lines: ok N3 P2048 B256",
    )


def _clock(text: str) -> float | None:
    """The scale of time; None for `fast`."""
    return None if text == "fast" else factor(text, "fast", 1000)


def _clients(text: str) -> int:
    if not (text.isascii() and text.isdigit() and 0 < int(text) < 1 << 16):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of clients from 1 to 65535")
    return int(text)


def _state(text: str) -> str:
    """The path of a folder, or a path at which a folder can be created."""
    if Path(filled(text)).exists() and not Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"{text} is no folder")
    return text


def run(arguments: argparse.Namespace) -> int:
    """Serves until interrupted by Ctrl-C or SIGTERM, and then switches heaters and laser off."""
    from passo import config
    from passo.config.own_machines import own_or_shipped

    folder = _state_of(arguments)
    state = None if folder is None else Path(folder)
    source = own_or_shipped(arguments.machine, state)
    if source != arguments.machine:
        print(f"The machine file is {source}, in place of the shipped one.", file=sys.stderr)
    machine, questions, _ = config.load_and_question(source)
    for question in questions:
        print(question, file=sys.stderr)
    machine = _with_boards(machine, arguments)
    if machine.board.link != "simulated" and arguments.clock != 1.0:
        where = f"{machine.board.port} keeps its own time"
        what = "leave --clock out, or add --simulated"
        print(f"passo serve: error: the board at {where}: {what}", file=sys.stderr)
        return ExitStatus.USAGE
    links = [Path(path).parent.resolve() / Path(path).name for path in arguments.pty]
    if twice := next((path for path in links if links.count(path) > 1), None):
        print(f"passo serve: error: --pty {twice} is given twice", file=sys.stderr)
        return ExitStatus.USAGE
    if arguments.log is None and (arguments.log_level or arguments.log_format):
        print("passo serve: error: --log-level and --log-format need --log FILE", file=sys.stderr)
        return ExitStatus.USAGE
    if arguments.klippy_socket is not None and not (arguments.sd and Path(arguments.sd).is_dir()):
        print(
            "passo serve: error: --klippy-socket needs --sd DIR, the folder that Moonraker has as"
            " gcodes",
            file=sys.stderr,
        )
        return ExitStatus.USAGE
    from passo.board.fault_injection import FaultOrder
    from passo.errors import CommandError
    from passo.library.printer import run as run_live

    if arguments.fault and machine.board.link != "simulated":
        raise CommandError.of("command.real-board")
    if arguments.fault == ["list"]:
        run_live(_list_faults(machine), clock="virtual")
        return ExitStatus.DONE
    orders = [FaultOrder.parse(text) for text in arguments.fault]
    log = None
    if arguments.log is not None:
        try:
            log = LogFile(
                arguments.log, arguments.log_format or "text", arguments.log_level or "info"
            )
        except OSError as error:
            reason = error.strerror or str(error)
            print(f"passo serve: error: --log {arguments.log}: {reason}", file=sys.stderr)
            return ExitStatus.USAGE
    with log or contextlib.nullcontext():
        clock = arguments.clock or "real"
        ending = Ending()
        serving = partial(_serve, arguments, orders=orders, log=log, ending=ending)
        while run_live(serving(machine, source), clock=clock) and not ending.asked:
            source = own_or_shipped(arguments.machine, state)
            machine = _with_boards(config.load(source), arguments)
    return ExitStatus.DONE


def _with_boards(machine: MachineConfig, arguments: argparse.Namespace) -> MachineConfig:
    """The machine with the boards of its file, or with simulated ones for `--simulated`."""
    from passo import config

    return config.on_simulated_boards(machine) if arguments.simulated else machine


def _state_of(arguments: argparse.Namespace) -> str | None:
    """The folder of the state; for `--simulated` that of `simulated_state`."""
    if arguments.state is None or not arguments.simulated:
        return arguments.state
    return str(simulated_state(Path(arguments.state)))


async def _list_faults(machine: MachineConfig) -> None:
    """Prints a line for each part that can have faults."""
    from passo.library.printer import Printer

    async with Printer(machine) as printer:
        for part, values in printer.faults.items():
            print(f"{part}={'|'.join(values)}")


async def _serve(
    arguments: argparse.Namespace,
    machine: MachineConfig,
    source: str,
    orders: list[FaultOrder],
    log: LogFile | None,
    ending: Ending,
) -> bool:
    """Serves once. Returns True if the printer must restart with the current machine file."""
    from passo.library.printer import Printer

    ours = asyncio.current_task()
    assert ours is not None
    ending.begin(ours)
    for number in endings():
        asyncio.get_running_loop().add_signal_handler(number, ending.ask)
    skips = skips_of(arguments)
    printer = Printer(
        machine,
        fast=arguments.clock is None,
        card=arguments.sd,
        state=_state_of(arguments),
        halt_reports=arguments.log and f"{arguments.log}-halt",
        skip_unknown=skips.unknown,
        skip_levelling=skips.levelling,
        clamp=skips.clamp,
        ignore_tools=skips.ignore_tools,
        machine_source=source,
        restarts=not arguments.stdin,  # with --stdin, the program ends with its console
    )
    advanced_ok: bool = arguments.advanced_ok
    restart = False
    # An interrupt by Ctrl-C or SIGTERM is the usual end.
    with contextlib.suppress(asyncio.CancelledError):
        async with printer, _logged(printer, log):
            for text in printer.start_messages:
                print(text.removeprefix("echo:"), file=sys.stderr)
            for order in orders:
                printer.inject_fault(
                    order.part, order.value, after_s=order.after_s, for_s=order.for_s
                )
            places: list[str] = []
            for path in arguments.pty:
                places.append(await printer.open_pty(path, advanced_ok=advanced_ok))
            for device, baud in arguments.serial:
                places.append(await printer.open_serial(device, baud, advanced_ok=advanced_ok))
            tcp = [address for address in arguments.tcp if address != "none"]
            silent = not (arguments.pty or arguments.serial or arguments.stdin)
            for host, port in tcp or ([TCP] if silent and not arguments.tcp else []):
                place = await printer.open_tcp(
                    host, port, clients=arguments.tcp_clients, advanced_ok=advanced_ok
                )
                places.append(place)
            if address := open_web(printer, arguments):
                places.append(address)
            if arguments.klippy_socket is not None:
                places.append(open_klippy(printer, arguments.klippy_socket, arguments.log))
            if arguments.stdin:
                # the user did not ask for the web
                alone = places == [address] and arguments.http is None
                over = printer.end if alone or not places else _go_on_serving
                places.append(await printer.open_stdin(over, advanced_ok=advanced_ok))
            served = f"{machine.name}{', simulated,' if arguments.simulated else ''}"
            where = ", ".join(places) or "no address"
            print(f"Serving {served} on {where}.", file=sys.stderr, flush=True)
            _log.info("Serving %s on %s", served, where)
            restart = await printer.serve()
            ending.close()
    return restart


@contextlib.asynccontextmanager
async def _logged(printer: Printer, log: LogFile | None) -> AsyncGenerator[None]:
    """Gives log records the print time of this printer, and reports a failed log on its
    consoles."""
    if log is None:
        yield
        return
    loop = asyncio.get_running_loop()
    show = partial(loop.call_soon_threadsafe, printer.show_message)
    with log.following(lambda: printer.time_s, show):
        yield


def _go_on_serving() -> None:
    """Does nothing: the printer is served after a console has ended, too."""
