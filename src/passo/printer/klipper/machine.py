"""Klipper's objects of the printer as a whole and of its boards."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from passo.printer.status import FilamentSensorStatus, Status

Object = dict[str, Any]


def webhooks(status: Status) -> Object:
    """The state of the printer; if it does not run, the reason and the next action."""
    if status.link == "restarting":
        return {"state": "startup", "state_message": "The boards start. Wait some seconds"}
    if not status.halted:
        return {"state": "ready", "state_message": "Printer is ready"}
    texts = [f"{fault.text}\n{fault.action} [{fault.code}]" for fault in status.faults]
    message = "\n".join(texts or [status.halted])
    return {
        "state": "shutdown" if status.started else "error",
        "state_message": f"{message}\nRestart the printer with FIRMWARE_RESTART or M999",
    }


def filament_sensor(sensor: FilamentSensorStatus) -> Object:
    """A filament sensor; one of the width has its diameter, too."""
    found: Object = {"filament_detected": sensor.detected, "enabled": sensor.enabled}
    if sensor.diameter_mm is not None:
        found |= {"Diameter": sensor.diameter_mm, "Raw": sensor.reading}
        found |= {"is_active": sensor.measures}
    return found


def mcu(status: Status, name: str) -> Object:
    """A board. Its load is 0 until the board reports one, and stays 0 on a simulated chip."""
    board = status.boards[name]
    return {
        "mcu_version": board.firmware,
        "mcu_build_versions": "",
        "mcu_constants": {"MCU": board.mcu, "CLOCK_FREQ": board.clock_hz},
        "last_stats": {
            "mcu_awake": board.awake_s or 0.0,
            "mcu_task_avg": board.task_s or 0.0,
            "mcu_task_stddev": board.task_deviation_s or 0.0,
            "bytes_write": board.bytes_sent,
            "bytes_retransmit": board.bytes_resent,
            "freq": board.clock_hz,
        },
    }
