"""Computations of shards that fail on purpose, for processes of the tests."""

import os
import signal
from pathlib import Path

from passo.study.work import compute


def dies_at_name(shard):
    """Dies at files whose name begins with `deadly`."""
    if any(Path(work.file.path).name.startswith("deadly") for work in shard.works):
        os.kill(os.getpid(), signal.SIGKILL)
    return compute(shard)


def stops_at_name(shard):
    """Stops at files whose name begins with `stuck`, as by SIGSTOP from outside."""
    if any(Path(work.file.path).name.startswith("stuck") for work in shard.works):
        os.kill(os.getpid(), signal.SIGSTOP)
    return compute(shard)


def needs_memory(shard):
    """Needs 8 GB for each case."""
    results = []
    for work in shard.works:
        try:
            bytearray(8 << 30)
        except MemoryError:
            results.append({"status": "memory", "file": work.file.path})
    return results
