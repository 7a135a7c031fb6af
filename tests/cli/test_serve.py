"""`passo serve` as a process: how it ends."""

from __future__ import annotations

import signal
import subprocess
import sys
from functools import partial

import pytest

from passo.cli.main import endings

ENDINGS = [signal.SIGTERM, signal.SIGINT, signal.SIGHUP]


@pytest.mark.parametrize("number", ENDINGS, ids=lambda number: number.name)
def test_an_interrupt_ends_it_in_order(tmp_path, number):
    # Whoever runs the tests in the background may have it ignore some, and its children too.
    heeded = partial(signal.signal, number, signal.SIG_DFL)
    link = tmp_path / "printer"
    words = [sys.executable, "-m", "passo", "serve", "--machine", "i3", "--pty", str(link)]
    words += ["--http", "none"]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True, preexec_fn=heeded) as served:
        assert served.stderr is not None
        assert served.stderr.readline().startswith("Serving i3 on")
        assert link.is_symlink()
        served.send_signal(number)
        assert "Traceback" not in served.stderr.read()
        assert served.wait() == 0
    assert not link.is_symlink()


def test_serve_survives_its_terminal_with_nohup():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert endings() == [signal.SIGTERM]
        signal.signal(signal.SIGHUP, signal.SIG_DFL)
        assert endings() == [signal.SIGTERM, signal.SIGHUP]
    finally:
        signal.signal(signal.SIGHUP, before)
