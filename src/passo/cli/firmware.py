"""`passo firmware`: lists boards, builds their firmware, and flashes and verifies a board."""

from __future__ import annotations

import argparse
import asyncio
import json
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from passo.cli.tables import columns
from passo.errors import ExitStatus, FirmwareError, Problem

if TYPE_CHECKING:
    from passo.config.board import Board


_TARGET = "BOARD|MACHINE.toml[:NAME]"
_TARGETS = "a board of `passo firmware list`, or that of a machine file, or its further board NAME"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the subcommands of `passo firmware`."""
    parts = parser.add_subparsers(dest="part", metavar="list|build|flash", required=True)
    listed = parts.add_parser("list", help="the boards, and how far their firmware is")
    listed.add_argument("--json", action="store_true", help="print one JSON list")
    built = parts.add_parser("build", help="make an image and a JSON file that says what it is")
    built.add_argument("target", metavar=_TARGET, help=_TARGETS)
    built.add_argument(
        "--output", type=Path, default=Path(), metavar="DIR", help="where to; default: here"
    )
    built.add_argument(
        "--for-older-hosts",
        action="store_true",
        help="for Kalico and Klipper hosts up to v0.13, which query analog inputs differently",
    )
    flashed = parts.add_parser("flash", help="bring an image onto a board, and ask who it is then")
    flashed.add_argument("target", metavar=_TARGET, help=_TARGETS)
    flashed.add_argument(
        "--port", metavar="PORT", help="serial port, such as /dev/ttyUSB0, or a drive's folder"
    )
    flashed.add_argument(
        "--image", type=Path, metavar="FILE", help="default: one is built for the occasion"
    )
    flashed.add_argument(
        "--dry-run", action="store_true", help="only show the steps, and what is missing for them"
    )


def run(arguments: argparse.Namespace) -> int:
    """Runs the subcommand. Raises FirmwareError, and ConfigError for a machine file with errors."""
    parts = {"list": _list, "build": _build, "flash": _flash}
    return parts[arguments.part](arguments)


def _list(arguments: argparse.Namespace) -> int:
    from passo import config
    from passo.toolchain.targets import state

    rows: list[dict[str, Any]] = []
    for name in config.shipped_boards():
        board = config.load_board(name)
        rows.append(
            {
                "board": name,
                "description": board.description,
                "mcu": board.mcu,
                "clock_hz": board.clock_hz if board.chip else None,
                "console": _console(board),
                "flash": board.flash.method if board.flash else None,
                "before": board.flash.before if board.flash else [],
                "after": board.flash.after if board.flash else [],
                "notes": board.notes,
                "state": state(board),
            }
        )
    if arguments.json:
        print(json.dumps(rows, indent=2))
        return ExitStatus.DONE
    table = [("BOARD", "MCU", "CONSOLE", "FLASHED WITH", "STATE")]
    for row in rows:
        table.append((row["board"], row["mcu"], row["console"], row["flash"] or "-", row["state"]))
    print(columns(table))
    return ExitStatus.DONE


def _console(board: Board) -> str:
    console = board.console
    if console is None:
        return "-"
    uart = f"{console.uart} " if console.uart else ""
    return f"{uart}{console.baud} baud"


def _build(arguments: argparse.Namespace) -> int:
    from passo.toolchain.build import build
    from passo.toolchain.targets import target

    aim, older = target(arguments.target), arguments.for_older_hosts
    image, about = build(aim, arguments.output, older_hosts=older)
    print(
        f"{image}: {about.flash_bytes} of {about.flash_size} bytes of flash,"
        f" {about.ram_bytes} of {about.ram_size} of RAM, sha256 {about.sha256[:16]}"
    )
    return ExitStatus.DONE


def _flash(arguments: argparse.Namespace) -> int:
    import tempfile

    from passo.toolchain.build import build
    from passo.toolchain.flash_plan import plan
    from passo.toolchain.flashing import User, flash, show_steps
    from passo.toolchain.targets import target

    aim = target(arguments.target)
    user = User(_tell, _wait)
    if arguments.dry_run:
        show_steps(aim, arguments.port, arguments.image, user)
        return ExitStatus.DONE
    with tempfile.TemporaryDirectory() as folder:
        image = arguments.image
        if image is None:
            plan(aim.name, aim.board, arguments.port, Path(folder))
            image, _ = build(aim, Path(folder))
        asyncio.run(flash(aim.name, aim.board, arguments.port, image, user))
    return ExitStatus.DONE


def _tell(text: str) -> None:
    print(text, flush=True)


def _wait(text: str) -> None:
    # The signal handler of the event loop would wait for the end of the input line.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        print(f"{text} Then press Enter.", flush=True)
        answer = sys.stdin.readline()
    finally:
        signal.signal(signal.SIGINT, before)
    if not answer:  # the input has ended without Enter
        raise FirmwareError([Problem("firmware.nobody", values={"value": text.rstrip(".")})])
