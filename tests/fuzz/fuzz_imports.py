"""Hostile configurations of other firmwares: each becomes a valid machine file, or a sentence that
names what is wrong. Usage, in the
root folder: python -m tests.fuzz.fuzz_imports SECONDS SEED FOLDER

Inputs are those of the tests of the readers, changed at random. One that raises anything else, or
takes longer than 20 s, is written to FOLDER, and the program ends with 1."""

from __future__ import annotations

import json
import random
import signal
import sys
import tempfile
import time
import traceback
from pathlib import Path

from tests.config import test_import_aprinter as of_aprinter
from tests.config import test_import_klipper as of_klipper
from tests.config import test_import_marlin as of_marlin

from passo import config
from passo.config.importing.formats import imported
from passo.errors import ConfigError

MAX_S = 20
SEEDS = {
    "printer.cfg": of_klipper.BASE
    + of_klipper.PROBE
    + "[bed_screws]\nscrew1: 10, 10\nscrew2: 100, 10\n[gcode_macro A]\ngcode:\n  {% for i in "
    "range(3) %}\n  G1 X{i}\n  {% endfor %}\n",
    "Configuration.h": of_marlin.BASE + of_marlin.PROBE + "#define BLTOUCH\n",
    "Configuration_Overall.h": of_marlin.STUFW,
    "m503.txt": of_marlin.DUMP,
    "aprinter.json": json.dumps(of_aprinter.DOCUMENT, indent=1),
}
TOKENS = [
    *(
        "\0",
        "\n",
        "\r",
        "\\\n",
        '"',
        "'",
        "{",
        "}",
        "[",
        "]",
        "(",
        ")",
        "#",
        "/*",
        "*/",
        "//",
        "\ufeff",
    ),
    *(
        "#if 1\n",
        "#else\n",
        "#endif\n",
        "#define A (A+A)\n",
        "[include printer.cfg]\n",
        "[include *]\n",
    ),
    *(
        '#include "Configuration.h"\n',
        "#*# [a]\n",
        "1e999",
        "-1",
        "nan",
        "1" * 400,
        "0x",
        "A",
        ":",
        "=",
    ),
    *(
        "(" * 600,
        "{" * 600,
        "[" * 600,
        "-" * 600,
        "!" * 600,
        "1+" * 300,
        "#if (\n" * 120,
        " " * 5000,
    ),
]


def changed(text: str, chance: random.Random) -> str:
    """The text after one to six changes."""
    for _ in range(chance.randint(1, 6)):
        a, b = sorted(chance.randrange(len(text) + 1) for _ in range(2))
        b = min(b, a + chance.choice([1, 8, 80, 800]))
        match chance.randrange(5):
            case 0:
                text = text[:a] + text[b:]
            case 1:
                text = text[:b] + text[a:b] * chance.choice([1, 2, 40]) + text[b:]
            case 2:
                text = text[:a] + chance.choice(TOKENS) + text[a:]
            case 3:
                text = text[:a] + chance.choice(TOKENS) + text[b:]
            case _:
                lines = text.split("\n")
                chance.shuffle(lines)
                text = "\n".join(lines)
    return text


def fails(path: Path) -> str:
    """What is wrong with how a file is imported; empty if nothing is."""
    try:
        if path.suffix == ".txt":
            base = path.with_name("Configuration.h")
            base.write_text(SEEDS[base.name], encoding="utf-8")
            draft = imported(base, path)
        else:
            draft = imported(path)
    except ConfigError as error:
        blank = not all(problem.sentence.strip() for problem in error.problems)
        return "an error without a sentence" if blank or not error.problems else ""
    except Exception:
        return traceback.format_exc()
    try:
        config.load_text(draft.text("From a fuzzer."), "machine.toml")
    except Exception:
        return traceback.format_exc()
    return ""


def main() -> int:
    """Tries changed inputs until the time is up."""
    seconds, seed, artifacts = int(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3])
    chance = random.Random(seed or None)

    def too_slow(*_: object) -> None:
        raise TimeoutError(f"more than {MAX_S} s")

    signal.signal(signal.SIGALRM, too_slow)
    ends, count = time.monotonic() + seconds, 0
    with tempfile.TemporaryDirectory() as folder:
        while time.monotonic() < ends:
            name = chance.choice(list(SEEDS))
            path = Path(folder, name)
            path.write_text(changed(SEEDS[name], chance), encoding="utf-8", errors="replace")
            signal.alarm(MAX_S)
            wrong = fails(path)
            signal.alarm(0)
            if wrong:
                artifacts.mkdir(parents=True, exist_ok=True)
                kept = artifacts / f"crash-{count}-{name}"
                kept.write_bytes(path.read_bytes())
                print(f"{kept}: {wrong}", file=sys.stderr)
                return 1
            for left in path.parent.iterdir():
                left.unlink()
            count += 1
    print(f"{count} inputs")
    return 0


if __name__ == "__main__":
    sys.exit(main())
