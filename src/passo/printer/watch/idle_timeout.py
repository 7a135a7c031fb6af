"""What goes off when a printer stands idle: motors, heaters, a laser, all of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.printer.printer import Printer

LASER_OFF_S = 3.0  # of standing with the laser on, no print being under way


def look_after_idleness(printer: Printer) -> None:
    """To be called as time passes."""
    idle_s, config = printer.drive.idle_s, printer.machine.idle
    nobody = (printer.job.suspended or printer.waits.person) and not printer.waits.heating
    if nobody and 0 < config.heaters_off_s < idle_s:
        _cool_hotends(printer)
    if printer.busy() or printer.turn.taken:
        return
    # Where something is kept warm a host may only have paused: its print must not lose its place.
    warm = any(heater.target > 0 for heater in printer.connection.heaters.values())
    motors_off = 0 < printer.motors.idle_s < idle_s and bool(printer.motors.on) and not warm
    if printer.commands.lit and (idle_s > LASER_OFF_S or motors_off):
        printer.laser_off()
        printer.tell("echo:Laser off after standing idle; M3 switches it on again")
        return
    if motors_off:
        printer.motors.all_off()
        printer.tell("echo:Motors off after standing idle; home before the next move")
    if 0 < printer.person.kill_s < idle_s:
        printer.halt(f"idle for {printer.person.kill_s:g} s (M85)")
    if 0 < config.heaters_off_s < idle_s:
        for name in printer.heaters:
            if printer.connection.heaters[name].target > 0:
                printer.set_target(name, 0.0, at_once=True)
                printer.tell(f"echo:Heater {name} off after standing idle")


def _cool_hotends(printer: Printer) -> None:
    """Nobody has come for long: filament must not cook. The bed holds the print, and stays."""
    for name, config in printer.machine.heaters.items():
        target = printer.connection.heaters[name].target
        if config.kind == "hotend" and target > 0:
            printer.cooled_c[name] = target
            printer.connection.set_target(name, 0.0)
            printer.tell(f"echo:Heater {name} off in a long pause; it warms up before all goes on")
