"""A summary of a printer from the objects and the history of Moonraker."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias, cast
from uuid import UUID

from passo.printer.status import FaultStatus, LastPrint
from passo.web.summary import Summary, SummaryHeater, SummaryJob, SummaryState

Result: TypeAlias = Literal["done", "cancelled", "failed"]
_RESULTS: Mapping[str, Result] = {"completed": "done", "cancelled": "cancelled"}
_IN_PROGRESS = "in_progress"
_HALTED = ("shutdown", "error")
_FRACTIONS = 3  # decimals of a progress


def run_of(path: str) -> str:
    """The id of the run to whose folder a file belongs, or an empty text."""
    folder = path.rpartition("/")[0].removeprefix("hub/")
    try:
        return folder if str(UUID(folder)) == folder else ""
    except ValueError:
        return ""


def state_of(status: str) -> Result | Literal["printing"]:
    """What the history of Moonraker says of a print."""
    return "printing" if status == _IN_PROGRESS else _RESULTS.get(status, "failed")


class Status:
    """What Moonraker has reported of one printer."""

    def __init__(self, id: str, name: str) -> None:
        self._id, self._name = id, name
        self._objects: dict[str, dict[str, Any]] = {}
        self._last: LastPrint | None = None
        self._gone: str | None = None

    def update(self, changes: Mapping[str, Mapping[str, Any]]) -> None:
        """Takes the changed fields of objects."""
        self._gone = None
        for name, fields in changes.items():
            self._objects.setdefault(name, {}).update(fields)

    def gone(self, message: str) -> None:
        """Klipper has stopped or ended."""
        self._gone = message

    def history(self, jobs: Sequence[Mapping[str, Any]]) -> None:
        """Takes the newest prints, the newest first."""
        ended = next((job for job in jobs if job["status"] != _IN_PROGRESS), None)
        if ended is None:
            return
        result = _RESULTS.get(ended["status"], "failed")
        reason = "" if result != "failed" else str(ended["status"]).replace("_", " ")
        path = str(ended["filename"])
        number = int(str(ended["job_id"]), 16)
        self._last = LastPrint(number, path, run_of(path), result, reason)

    def summary(self) -> Summary | None:
        """The summary; None before the first report."""
        if not self._objects:
            return None
        stats = self._objects.get("print_stats", {})
        hooks = self._objects.get("webhooks", {})
        state, fault = self._state(stats, hooks)
        prints = state in ("printing", "paused")
        return Summary(
            self._id,
            self._name,
            "Moonraker",
            state,
            self._job(stats) if prints else None,
            self._last,
            tuple(self._heaters()),
            fault,
        )

    def _state(
        self, stats: Mapping[str, Any], hooks: Mapping[str, Any]
    ) -> tuple[SummaryState, FaultStatus | None]:
        klippy = hooks.get("state", "ready")
        if self._gone is not None or klippy in _HALTED:
            text = self._gone or str(hooks.get("state_message", "")) or "Klipper has stopped"
            first = text.strip().partition("\n")[0]
            return "halted", FaultStatus("klipper", "printer", first, "Restart the firmware")
        if klippy != "ready":
            return "busy", None
        if stats.get("state") == "printing":
            return "printing", None
        if stats.get("state") == "paused":
            return "paused", None
        busy = self._objects.get("idle_timeout", {}).get("state") == "Printing"
        return ("busy" if busy else "idle"), None

    def _job(self, stats: Mapping[str, Any]) -> SummaryJob:
        path = str(stats.get("filename") or "")
        card = self._objects.get("virtual_sdcard", {})
        info = cast("dict[str, Any]", stats.get("info") or {})
        fraction = round(float(card.get("progress") or 0.0), _FRACTIONS)
        printed_s = round(float(stats.get("print_duration") or 0.0))
        # Klipper has no time of the rest; the part of the file is the usual guess.
        left_s = round(printed_s / fraction - printed_s) if fraction > 0.01 else None
        return SummaryJob(
            path,
            run_of(path),
            fraction,
            left_s,
            printed_s,
            int(info.get("current_layer") or 0),
            info.get("total_layer"),
            round(float(stats.get("filament_used") or 0.0)),
        )

    def _heaters(self) -> list[SummaryHeater]:
        return [
            SummaryHeater(
                "bed" if name == "heater_bed" else name,
                round(fields["temperature"]) if fields.get("temperature") is not None else None,
                round(fields.get("target") or 0),
            )
            for name, fields in sorted(self._objects.items())
            if name == "heater_bed" or name.startswith("extruder")
        ]
