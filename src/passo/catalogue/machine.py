"""Errors that halt the machine or end a connection to its boards, and refusals to change it."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus


def _config(says: str, action: str) -> Entry:
    return Entry("config", says, action, ExitStatus.BAD_CONFIG)


MACHINE: Mapping[str, Entry] = {
    "machine.no-file": _config(
        "{value} cannot be changed: it comes with Passo, or a program made it",
        "Save the text as a file of your own, and start with --machine FILE.toml",
    ),
    "machine.no-folder": _config(
        "there is no folder for a machine file of your own in place of {value}",
        "Start with --state DIRECTORY and a shipped machine, then save it again",
    ),
    "machine.file-changed": _config(
        "the machine file has changed since it was read",
        "Read it again, and compare it with your text",
    ),
    "machine.no-restart": _config(
        "Passo cannot restart itself, because a program opened the printer, or it runs with"
        " --stdin",
        "Stop Passo and start it again",
    ),
    "machine.switch-missed": Entry(
        "homing",
        "{axis} was not homed: {value} was not triggered within {limit} towards {position}",
        "Check that the axis moved towards the endstop, and what M119 reports while you press it",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.switch-lost": Entry(
        "homing",
        "{axis} was not homed: the boards of {value} and of its motor lost their connection",
        "Check the cables of the boards, and whether other programs keep this computer busy",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.switch-stuck": Entry(
        "homing",
        "{axis} was not homed: {value} is still triggered {limit} away from {position}",
        "Check its wiring and the ! in front of its pin, or raise its retract distance",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.stall-missed": Entry(
        "homing",
        "{axis} was not homed: the {value} detected no stall within {limit} towards {position}",
        "If the axis stood at its end, make the detection more sensitive (M914): SGTHRS higher, SGT"
        " lower; or home faster, up to one rotation of the motor in a second",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.stall-early": Entry(
        "homing",
        "{axis} was not homed: the {value} detected a stall after {limit}, also in a second try",
        "If the axis moves freely, make the detection less sensitive (M914): SGTHRS lower, SGT"
        " higher; or raise homing.stall.current_a",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.stall-unstable": Entry(
        "homing",
        "the stall detection of axis {axis} is not reliable: the thresholds {value} stop it at its"
        " end, and not before; at least {limit} are needed",
        "Home faster (homing.fast), up to one rotation of the motor in a second, or set another"
        " homing.stall.current_a; then calibrate again",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.stall-shown": Entry(
        "homing",
        "{axis} was not homed: the {value} shows a stall while its motor is at rest",
        "Check the wire and the ! in front of the pin, and what M122 reports about the driver",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.emergency-stop": Entry(
        "job",
        "emergency stop by M112",
        "Remove the M112 from the file, or end the program there with M2",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.stop-button": Entry(
        "board",
        "the stop button {value} was pressed",
        "Make the printer safe, release the button, then send M999",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.restart": Entry(
        "printer",
        "FIRMWARE_RESTART restarts the printer",
        "Home the axes before you move them",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.stopped": Entry(
        "job",
        "the print was stopped by M410",
        "Remove the M410 from the file, or end the program there with M2",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.slow-heater": Entry(
        "heat",
        "heater {axis} has reached only {value:.1f} °C of {limit:.1f} °C in an hour",
        "Check its cartridge, its supply, and that its sensor is seated",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.unreachable": Entry(
        "board",
        "the board cannot be reached at {axis}: {value}",
        "Check its cable and supply, and link and port in the machine file. Without a board, start"
        " passo serve with --simulated",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.port-in-use": Entry(
        "board",
        "another program has {axis} open",
        "Stop that program first, for example a running Klipper: sudo systemctl stop klipper",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.silent": Entry(
        "board",
        "the board does not answer {value}",
        "Check its supply, the baud rate, and that its firmware is Passo's or Klipper's",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.dictionary": Entry(
        "board",
        "the board's dictionary does not fit the machine file: {value}",
        "Choose the right board and firmware in the machine file, or build the firmware for it",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.no-reset": Entry(
        "board",
        "{value} is in use and cannot be restarted by a command",
        "Switch its supply off and on (restart the program klipper_mcu of a Linux computer), then"
        " try again",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.old-firmware": Entry(
        "board",
        "the board's firmware is older than this program",
        "Build and flash it again: passo firmware flash",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.closed": Entry(
        "board",
        "the connection to the board has ended",
        "Check its cable and supply, and start again",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.link-failed": Entry(
        "board",
        "the connection to the board was ended: {value}",
        "Check that its firmware is Passo's or Klipper's and fits the machine file",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.alone": Entry(
        "board",
        "the board ran out of commands and braked to a stop",
        "End other programs on the computer, use a shorter or faster link, or start again",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.began-anew": Entry(
        "board",
        "{value} restarted (reset or power failure); position lost",
        "Home the machine; M1000 resumes a print from the card",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.place-unknown": Entry(
        "board",
        "the board does not report where it stopped when the link was lost",
        "Home the machine; M1000 resumes a print from the card",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.displaced": Entry(
        "board",
        "motor {axis} stopped at {value} steps when the link was lost, not at {limit}",
        "Home the machine; M1000 resumes a print from the card",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.no-power": Entry(
        "board",
        "the power supply is off, and a motor was to move",
        "Make the printer safe, switch the power supply on (M80), then send M999",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.idle": Entry(
        "job",
        "idle for {value:g} s (M85)",
        "Make the printer safe, then send M999",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.unstopped": Entry(
        "board",
        "the emergency stop has not reached {value}, which may heat for up to a minute",
        "Cut the printer's power, or restore the connection",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.program": Entry(
        "program",
        "a fault of the program, {value}",
        "Report it, with the last lines that the host has sent",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.shutdown": Entry(
        "board",
        "the board shut down: {value}",
        "Remove the cause, then start again or send M999",
        ExitStatus.MACHINE_FAULT,
    ),
}
