"""A real hub over real printers in processes: killed, frozen and full."""

from __future__ import annotations

import json
import signal
import subprocess
import time
import urllib.request
from collections import Counter
from pathlib import Path
from typing import Any

from tests.support.card_images import ENVIRONMENT
from tests.support.served_hub import ServedHub
from tests.support.served_printer import ServedPrinter

from passo.card import open_card

SILENT_S, LOST_S = 1.5, 1.0
_PRINT = b"G28\nG1 Z5 F600\n" + b"G1 X20 Y20 F6000\nG1 X100 Y20\n" * 4
_CARD, _RESERVE = 40 << 20, 16 << 20


def full_card(path: Path) -> Path:
    """A card on which no file has a place."""
    with path.open("wb") as file:
        file.truncate(_CARD)
    command = ["mkfs.fat", "-F", "32", str(path)]
    subprocess.run(command, check=True, env=ENVIRONMENT, capture_output=True)
    card = open_card(path)
    writer = card.create("/photos.bin")
    writer.write(bytes(card.free_bytes - _RESERVE + (1 << 16)))
    writer.close()
    card.close()
    return path


def past_runs(printer: ServedPrinter) -> list[str]:
    """The runs in the history of a printer."""
    with urllib.request.urlopen(f"{printer.url}/api/v1/job/past", timeout=20) as answer:
        return [row["run"] for row in json.loads(answer.read())]


def check_runs(hub: ServedHub, printers: list[ServedPrinter], job: str, quantity: int) -> None:
    """No run has started twice, none is lost, and the job has printed what it had to."""
    rows: list[dict[str, Any]] = hub.ask("GET", f"/runs?limit=1000&job={job}")
    ended = Counter(row["state"] for row in rows)
    assert ended["done"] == quantity, ended
    assert ended.keys() <= {"done", "failed", "cancelled"}, ended
    printed = Counter(run for printer in printers for run in past_runs(printer))
    assert max(printed.values()) == 1, printed
    known = {row["id"]: row for row in rows}
    assert printed.keys() <= known.keys()
    assert {id for id, row in known.items() if row["state"] == "done"} <= printed.keys()


def prints(hub: ServedHub) -> bool:
    """Whether a printer prints."""
    return any(printer["condition"] == "printing" for printer in hub.printers().values())


def run_farm(
    folder: Path,
    count: int,
    quantity: int,
    *,
    frozen_s: float,
    within_s: float,
    limits: tuple[float, float],
) -> list[dict[str, Any]]:
    """Prints a job on so many printers, one of them with a full card. The hub is killed while
    prints run and while files are sent, and one printer is frozen for a while."""
    full = full_card(folder / "card.img")
    printers = [ServedPrinter(folder / f"p{n}", clock="1.5") for n in range(count - 1)]
    printers.append(ServedPrinter(folder / "full", card=full))
    for printer in printers:
        printer.serving()
    hub = ServedHub(folder / "hub", *limits)
    try:
        hub.add(printers)
        job = hub.job("part.gcode", _PRINT, quantity=quantity, retries=3)
        hub.clear_beds()
        hub.wait(lambda: prints(hub), within_s)
        hub.kill()
        hub.begin()
        hub.wait(lambda: hub.printers()["p0"]["condition"] != "connecting", within_s)
        frozen = printers[0]
        frozen.signal(signal.SIGSTOP)
        thaw = time.monotonic() + frozen_s
        conditions: set[str] = set()

        def over() -> bool:
            nonlocal thaw
            shown = hub.printers()
            conditions.add(shown["p0"]["condition"])
            if thaw and time.monotonic() > thaw:
                frozen.signal(signal.SIGCONT)
                thaw = 0.0
            hub.clear_beds()
            return not thaw and not hub.ask("GET", "/jobs")

        hub.wait(over, within_s)
        check_runs(hub, printers, job, quantity)
        assert "unreachable" in conditions
        return hub.ask("GET", f"/runs?limit=1000&job={job}")
    finally:
        hub.kill()
        for printer in printers:
            printer.signal(signal.SIGCONT)
            printer.kill()


def test_killed_hub_frozen_printer_and_full_card_lose_no_run(tmp_path: Path) -> None:
    """Takes about 30 s: four processes, real time between their words, and real prints. Only
    processes show that a killed hub continues from its disk, and that a frozen printer is noticed
    by its silence."""
    found = run_farm(tmp_path, 3, 3, frozen_s=6.0, within_s=90.0, limits=(SILENT_S, LOST_S))
    reasons = [row["reason"] for row in found]
    assert any("card" in reason.lower() for reason in reasons), reasons
