"""Another firmware library than the package's."""

from __future__ import annotations

import subprocess
from pathlib import Path

from passo.toolchain.declarations import gather
from passo.toolchain.tables import dictionary, write_tables

FIRMWARE = Path(__file__).parents[2] / "firmware"


def library_for_older_hosts(folder: Path) -> Path:
    """With analog inputs and converters in the words of older hosts; made in `folder`."""
    newer = ("analog_report.c", "thermocouple_words.c")
    core = [s for s in FIRMWARE.glob("core/*.c") if s.name not in newer]
    sources = [
        *sorted(core),
        FIRMWARE / "alternative/analog_value.c",
        FIRMWARE / "alternative/thermocouple_words.c",
        FIRMWARE / "hal/common/stepgen.c",
        FIRMWARE / "hal/host/host.c",
    ]
    found = gather(sources)
    sources += write_tables(found, dictionary(found, version="test"), folder)
    folders = [*(FIRMWARE / f for f in ("core", "hal", "hal/common", "hal/host")), folder]
    made = folder / "firmware.so"
    subprocess.run(
        ["cc", "-std=c11", "-O2", "-shared", "-fPIC", "-fno-strict-aliasing", "-Wall", "-Wextra",
         "-Werror", *(f"-I{f}" for f in folders), *map(str, sources), "-o", str(made)],
        check=True,
    )  # fmt: skip
    return made
