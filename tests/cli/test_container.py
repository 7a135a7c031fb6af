"""The Dockerfile: its stages, commands, options and extras exist."""

import argparse
import json
import re
import tomllib
from itertools import pairwise
from pathlib import Path

import pytest

from passo.cli import hub, serve

ROOT = Path(__file__).parents[2]
LINES = re.sub(r"\\\n", " ", (ROOT / "Dockerfile").read_text()).splitlines()


def of(word):
    """The arguments of all instructions of a kind."""
    return [line.partition(" ")[2].strip() for line in LINES if line.startswith(f"{word} ")]


def test_container_serves_a_simulated_printer_to_other_computers():
    (command,) = of("CMD")
    subcommand, *options = json.loads(command)
    parser = argparse.ArgumentParser()
    serve.add_arguments(parser)
    given = parser.parse_args(options)
    assert (subcommand, given.simulated, given.http) == ("serve", True, ("0.0.0.0", 4000))
    assert of("EXPOSE") == ["4000 4100"]
    assert json.loads(of("ENTRYPOINT")[-1]) == ["passo"]


def test_container_commands_of_the_how_to_are_understood():
    page = (ROOT / "docs/how-to/run-in-a-container.md").read_text()
    found = re.findall(r"passo (serve|hub) (--[^`\n]*)", re.sub(r"\\\n", " ", page))
    assert {name for name, _ in found} == {"serve", "hub"}
    for name, options in found:
        parser = argparse.ArgumentParser()
        {"serve": serve, "hub": hub}[name].add_arguments(parser)
        given = parser.parse_args(options.split())
        assert given.state == "."
        assert given.http[0] == "0.0.0.0"


def test_container_keeps_state_and_card_in_its_volume():
    (volume,), (folder,) = of("VOLUME"), of("WORKDIR")[1:]
    assert volume == folder == "/var/lib/passo"
    options = json.loads(of("CMD")[0])
    kept = dict(pairwise(options))
    assert (kept["--state"], kept["--sd"]) == (".", "card")
    assert f"{volume}/card" in " ".join(of("RUN"))


def test_container_runs_as_a_user_of_its_own():
    assert of("USER") == ["passo"]
    stages = [line.split()[-1] for line in of("FROM")]
    assert stages.index("base") < stages.index("worker") < stages.index("printer")


def test_container_installs_extras_and_locks_that_exist():
    text = " ".join(of("RUN"))
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = {
        name for found in re.findall(r"\.whl\)\[([\w,]+)\]", text) for name in found.split(",")
    }
    assert wanted == {"web", "hub", "mdns", "resonance", "cluster"}
    assert wanted <= set(extras["optional-dependencies"])
    locks = re.findall(r"requirements/\w+\.lock", text)
    assert locks
    for lock in locks:
        assert (ROOT / lock).exists()
    assert re.search(r"^wheel:", (ROOT / "Makefile").read_text(), re.MULTILINE)


@pytest.mark.parametrize("lock", ["run", "dev"])
def test_container_pins_the_versions_of_each_lock(lock):
    (pattern,) = re.findall(r"sed -n 's/(.*?)/\\1/p'", (ROOT / "Dockerfile").read_text())
    lines = (ROOT / f"requirements/{lock}.lock").read_text().splitlines()
    python = pattern.replace(r"\(", "(").replace(r"\)", ")")
    pinned = [match[1] for line in lines if (match := re.match(python, line))]
    assert len(pinned) == sum("==" in line and not line.startswith(" ") for line in lines)
    assert not any("hash" in one or "\\" in one for one in pinned)


def test_worker_starts_one_process_for_each_processor():
    words = json.loads(of("ENTRYPOINT")[0])
    assert words[:4] == ["dask", "worker", "--nworkers", "auto"]
    assert words[4:6] == ["--nthreads", "1"]
