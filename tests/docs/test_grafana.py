"""The dashboard of Grafana asks for metrics and labels that printers and the hub have."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from tests.support.farm_web import FarmWeb, with_farm
from tests.web.fake_bridge import STATUS, FakeBridge
from tests.web.local_site import local_client

from passo.printer.status import JobStatus

ROOT = Path(__file__).parents[2]
DASHBOARD = json.loads((ROOT / "examples/grafana-farm.json").read_text())
QUERIES = [target["expr"] for panel in DASHBOARD["panels"] for target in panel["targets"]]
OF_PROMETHEUS = {"printer"}  # the label that its configuration adds
SAMPLE = re.compile(r"^(passo_\w+)(?:\{(.*)\})? ", re.MULTILINE)


def names_and_labels(text):
    """The labels of each metric in Prometheus' format."""
    found = {name: set() for name in re.findall(r"^# TYPE (\w+)", text, re.MULTILINE)}
    for name, labels in SAMPLE.findall(text):
        found[name] |= set(re.findall(r"(\w+)=", labels))
    return found


@pytest.fixture
def metrics(tmp_path):
    bridge = FakeBridge()
    bridge.show(replace(STATUS, job=JobStatus("part.gcode", 0.25, 10, 1, 8, 60.0, 180.0)))
    with local_client(bridge) as client:
        found = names_and_labels(client.get("/metrics").text)

    async def hub(web: FarmWeb):
        await web.world.add(web.printers[0], "school")
        await web.client.put("/power/circuit", json={"limit_w": 3000})
        found.update(names_and_labels((await web.client.get("/../../metrics")).text))

    with_farm(tmp_path, "a")(hub)
    return found


def test_dashboard_asks_for_metrics_that_exist(metrics):
    asked = {name for query in QUERIES for name in re.findall(r"passo_\w+", query)}
    assert asked <= set(metrics)
    assert {"passo_state", "passo_temperature_celsius", "passo_job_progress_ratio"} <= asked
    assert {"passo_hub_runs_total", "passo_hub_queue_length"} <= asked


def test_dashboard_groups_by_labels_that_exist(metrics):
    labels = set().union(*metrics.values()) | OF_PROMETHEUS | {"result", "group"}
    for panel in DASHBOARD["panels"]:
        for target in panel["targets"]:
            used = {
                name
                for names in re.findall(r"by \(([\w, ]+)\)", target["expr"])
                for name in names.split(", ")
            }
            used |= set(re.findall(r"{{(\w+)}}", target["legendFormat"]))
            used |= set(re.findall(r"(\w+)=", target["expr"])) - {""}
            assert used <= labels, panel["title"]


def test_dashboard_is_one_picture_without_overlaps():
    cells = set()
    for panel in DASHBOARD["panels"]:
        place = panel["gridPos"]
        own = {
            (x, y)
            for x in range(place["x"], place["x"] + place["w"])
            for y in range(place["y"], place["y"] + place["h"])
        }
        assert place["x"] + place["w"] <= 24
        assert not own & cells, panel["title"]
        cells |= own
    assert len({panel["id"] for panel in DASHBOARD["panels"]}) == len(DASHBOARD["panels"])


def test_states_of_the_dashboard_are_those_of_printers(metrics):
    (panel,) = [p for p in DASHBOARD["panels"] if p["type"] == "state-timeline"]
    shown = [
        row["text"] for row in panel["fieldConfig"]["defaults"]["mappings"][0]["options"].values()
    ]
    assert shown == ["idle", "busy", "printing", "paused", "halted"]
    for number, state in enumerate(shown[1:], 1):
        part = rf"{number} \* sum by \(printer\) \(passo_state\{{[^}}]*state=\"{state}\"\}}\)"
        assert re.search(part, panel["targets"][0]["expr"])
