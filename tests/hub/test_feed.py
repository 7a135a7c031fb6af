"""The feed of the hub: the whole farm, then what has changed, within a budget of bytes."""

from __future__ import annotations

import json
from typing import Any

import pytest
from msgspec.structs import replace

from passo.hub.feed import BUDGET, INTERVAL_S, Audience
from passo.hub.slicer_facts import SlicerFacts, facts_in
from passo.hub.views import Farm, JobView, PowerGroup, PrinterView
from passo.web.summary import Summary, SummaryHeater, SummaryJob


def printer(number: int, fraction: float = 0.0, **fields: Any) -> PrinterView:
    """A printer in mid-print, with names as long as in a school."""
    path = f"/hub/{'bracket ' * 5}{number:03}.gcode"
    job = SummaryJob(path, f"run-{number:032}", fraction, 3600.0, 60.0, 12, 300, 1234.0)
    heaters = (SummaryHeater("hotend", 210, 210), SummaryHeater("bed", 60, 60))
    id = f"{number:036}"
    seen = Summary(id, f"Printer {number}", "0.1.0", "printing", job, None, heaters)
    known = {"condition": "printing", "bed_clear": False, "seen": seen, "tags": ("school",)}
    url = f"http://192.168.1.{number}:4000"
    return PrinterView(id, f"Printer {number}", url, "passo", **{**known, **fields})


def message(audience: Audience, farm: Farm) -> tuple[dict[str, Any], bool]:
    text, complete = audience.changes(farm)
    return json.loads(text) if text else {}, complete


def test_only_what_has_changed_is_sent():
    farm = Farm((printer(1), printer(2)), (JobView("j", "f" * 64, "part", 2),))
    audience = Audience(farm)
    assert json.loads(audience.whole())["farm"]["printers"][1]["name"] == "Printer 2"
    assert message(audience, farm) == ({}, True)
    changed = Farm((printer(1), printer(2, 0.5)), farm.jobs, (PowerGroup("left", 3000.0),))
    news, complete = message(audience, changed)
    assert complete
    assert [one["name"] for one in news["printers"]] == ["Printer 2"]
    assert (news["jobs"], news["gone"]) == ([], [])
    assert news["groups"] == [{"name": "left", "limit_w": 3000.0, "used_w": 0.0}]
    assert message(audience, changed) == ({}, True)


def test_removed_printers_and_jobs_are_gone():
    audience = Audience(Farm((printer(1),), (JobView("j", "f" * 64, "part", 2),)))
    news, _ = message(audience, Farm((), (), queue_paused=True))
    assert (sorted(news["gone"]), news["queue_paused"]) == (sorted([printer(1).id, "j"]), True)


def test_message_of_200_printers_keeps_to_its_budget():
    audience = Audience(Farm(tuple(printer(n) for n in range(200)), ()))
    shown: dict[str, int] = {}
    for second in range(1, 7):
        farm = Farm(tuple(printer(n, second / 1000) for n in range(200)), ())
        text, complete = audience.changes(farm)
        assert len(text) / INTERVAL_S <= 100_000
        assert not complete
        for one in json.loads(text)["printers"]:
            shown[one["id"]] = shown.get(one["id"], 0) + 1
    assert len(shown) == 200  # none waits for ever
    assert max(shown.values()) - min(shown.values()) <= 1
    assert BUDGET < 100_000


def test_state_comes_before_progress_of_others():
    audience = Audience(Farm(tuple(printer(n) for n in range(200)), ()))
    later = [printer(n, 0.5) for n in range(200)]
    later[199] = replace(later[199], condition="halted", attention="Heater fault")
    news, complete = message(audience, Farm(tuple(later), ()))
    assert not complete
    assert news["printers"][0]["attention"] == "Heater fault"


PRUSA = "; filament used [mm] = 1200.5, 20.0\n; estimated printing time (normal mode) = 1h 2m 3s\n"


@pytest.mark.parametrize(
    ("text", "facts"),
    [
        ("G28\n", SlicerFacts()),
        (
            f"{PRUSA}; filament_type = PLA;PETG\n; nozzle_diameter = 0.4,0.4\n",
            SlicerFacts(("PLA", "PETG"), 0.4, 3723.0, 1220.5),
        ),
        (";TIME:666\n;Filament used: 1.5m\n", SlicerFacts((), None, 666.0, 1500.0)),
        (
            ";Print Time: 90\n;Material#1 Used: 12.5\n;Nozzle Diameter#1: 0.60\n"
            ";Filament Type#1: ABS\n",
            SlicerFacts(("ABS",), 0.6, 90.0, 12.5),
        ),
        ("; model printing time: 5m; total estimated time: 1m 30s\n", SlicerFacts(print_s=90.0)),
    ],
    ids=["none", "PrusaSlicer", "Cura", "ideaMaker", "Bambu Studio"],
)
def test_facts_of_slicers(text, facts):
    assert facts_in(text) == facts
