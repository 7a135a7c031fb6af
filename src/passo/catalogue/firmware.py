"""Errors of building firmware and of flashing a board."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus


def _firmware(says: str, action: str, status: ExitStatus = ExitStatus.USAGE) -> Entry:
    return Entry("firmware", says, action, status)


FIRMWARE: Mapping[str, Entry] = {
    "firmware.board": _firmware(
        "there is no board called {value!r}",
        "Name one of `passo firmware list`, or the path of a machine file",
    ),
    "firmware.none": _firmware(
        "there is no firmware of Passo for {axis}: {value}", "See `passo firmware list`"
    ),
    "firmware.busy": _firmware(
        "firmware is being built or flashed already", "Wait until it is done, or cancel it"
    ),
    "firmware.not-now": _firmware(
        "a board cannot be flashed now: {value}",
        "Wait until the print is done, switch all heaters off, and try again",
    ),
    "firmware.port-used": _firmware(
        "{value} is in use: this printer is connected through it",
        "Stop `passo serve`, then flash the board with `passo firmware flash` on that computer",
    ),
    "firmware.image": _firmware(
        "{value} is not an image for {axis}: expected {limit}",
        "Build one (`passo firmware build`), or name the right file",
    ),
    "firmware.port": _firmware(
        "{axis} cannot be flashed through {value}: expected {limit}",
        "Plug the board in and name its port with --port",
    ),
    "firmware.no-port": _firmware(
        "no port was named for {axis}: it needs {limit}",
        "Plug the board in and name its port with --port",
    ),
    "firmware.nobody": _firmware(
        "no user has confirmed this step: {value}", "Flash from an interactive terminal"
    ),
    "firmware.tool": _firmware(
        "{axis} needs the program {value}, which is missing", "Install it, and try again"
    ),
    "firmware.clock": _firmware(
        "{axis} has a clock of {value} MHz, but the firmware for its chip runs at {limit} MHz",
        "Leave clock_hz out of the machine file: it is for simulated boards and for AVR chips",
    ),
    "firmware.build": _firmware(
        "the firmware of {axis} could not be built: {value}",
        "Check the pins of the motors, and the compiler",
        ExitStatus.BAD_INPUT,
    ),
    "firmware.flash": _firmware(
        "{axis} was not flashed: {value}",
        "Check the cable, the port and the manual steps, and try again",
        ExitStatus.MACHINE_FAULT,
    ),
    "firmware.silent": _firmware(
        "{axis} does not identify itself at {value}",
        "Do the manual steps after flashing, then reset the board; or flash it again",
        ExitStatus.MACHINE_FAULT,
    ),
    "firmware.other": _firmware(
        "{axis} runs another image than the one that was flashed: {value}",
        "Flash it again, and check that this is the board on that port",
        ExitStatus.MACHINE_FAULT,
    ),
}
