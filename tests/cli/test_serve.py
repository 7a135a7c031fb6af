"""`passo serve` as a process: how it ends."""

from __future__ import annotations

import signal
import subprocess
import sys
from functools import partial

import pytest

# Whoever runs the tests in the background may have it ignore interrupts, and its children too.
heeded = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT], ids=["SIGTERM", "SIGINT"])
def test_an_interrupt_ends_it_in_order(tmp_path, number):
    link = tmp_path / "printer"
    words = [sys.executable, "-m", "passo", "serve", "--machine", "i3", "--pty", str(link)]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True, preexec_fn=heeded) as served:
        assert served.stderr is not None
        assert served.stderr.readline().startswith("Serving i3 on")
        assert link.is_symlink()
        served.send_signal(number)
        assert "Traceback" not in served.stderr.read()
        assert served.wait() == 0
    assert not link.is_symlink()
