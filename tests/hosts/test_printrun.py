"""Printrun's printcore and pronsole print on `passo serve`.

Over TCP printcore sends neither line numbers nor checksums, since TCP loses nothing: there is no
noisy link over TCP here.
"""

import json
import subprocess
from pathlib import Path

import pytest
from tests.hosts.noise import Noise

HERE = Path(__file__).parent


@pytest.fixture
def printed(hosts, program):
    """Prints with printcore, the common program if no file is named; returns what it has seen."""

    def run(port, file=program.path, **events):
        options = [x for k, v in events.items() for x in (f"--{k}-at", str(v))]
        words = [
            str(hosts / "python"),
            str(HERE / "printcore_print.py"),
            port,
            str(file),
            *options,
        ]
        done = subprocess.run(words, capture_output=True, text=True, timeout=70)
        assert done.returncode == 0, done.stdout + done.stderr
        return json.loads(done.stdout or "{}")

    return run


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_printrun_prints_to_the_end(router, printed, whole, way):
    seen = printed(getattr(router, way), whole.path)
    assert seen["resends"] == 0
    assert {k: v for k, v in router.position().items() if k in whole.end} == whole.end


def test_a_line_that_came_in_damaged_is_printed_once(printer, printed, at_end, tmp_path):
    noise = Noise(seed=2).on_pty(printer.pty, tmp_path / "noisy")
    try:
        seen = printed(str(tmp_path / "noisy"))
    finally:
        noise.close()
    assert noise.damaged >= 10
    assert seen["resends"] >= noise.damaged
    at_end(printer)


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_a_pause_loses_nothing(printer, printed, at_end, way):
    seen = printed(getattr(printer, way), pause=600)
    assert seen["paused_at"] >= 600
    assert seen["sent_in_pause"] <= 1
    at_end(printer)


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_after_a_cancel_it_prints_again(printer, program, printed, at_end, way):
    seen = printed(getattr(printer, way), cancel=600)
    assert seen["cancelled_at"] < program.lines - 100
    printed(getattr(printer, way))
    at_end(printer)


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_a_host_that_vanished_in_mid_print_comes_back(printer, printed, at_end, way):
    printed(getattr(printer, way), vanish=600)
    printed(getattr(printer, way))
    at_end(printer)


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_pronsole_uploads_to_the_card_and_prints_from_there(hosts, printer, program, at_end, way):
    words = [str(hosts / "python"), str(HERE / "pronsole_card.py"), getattr(printer, way)]
    words += [str(program.path), "gear.g"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=70)
    assert done.returncode == 0, done.stdout + done.stderr
    stored = (printer.card / "gear.g").read_text()
    if way == "tcp":
        stored = stored.replace("M105\n", "")  # pronsole's own, which nothing tells from the file's
    assert stored == program.text
    at_end(printer)
