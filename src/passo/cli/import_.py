"""`passo import FILE`: converts a configuration of another firmware to a machine file."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING

from passo.errors import ConfigError, ExitStatus, InputError

if TYPE_CHECKING:
    from passo.config.importing.draft import Draft, Remark

_HEADINGS = {"decide": "To decide", "changed": "Changed", "dropped": "Not taken over"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments of `passo import`."""
    parser.add_argument(
        "file",
        metavar="FILE",
        help="Klipper's printer.cfg, Marlin's Configuration.h, APrinter's JSON, or RepRapFirmware's"
        " config.g",
    )
    parser.add_argument(
        "--output",
        metavar="MACHINE.toml",
        help="the file to make; default: the name of FILE, .toml",
    )
    parser.add_argument(
        "--stored",
        metavar="FILE",
        help="what the firmware has stored since: its answer to M503, or aprinter.cfg",
    )
    parser.add_argument(
        "--board",
        metavar="NAME",
        help="the main board, by its name in `passo firmware list`; default: the one in FILE",
    )
    parser.add_argument(
        "--state",
        metavar="DIR",
        help="store the meshes and skews of the file there, for `passo serve --state DIR`",
    )
    parser.add_argument(
        "--report", metavar="FILE", help="write the report there, not on the terminal"
    )


def run(arguments: argparse.Namespace) -> int:
    """Writes the machine file, which is valid, and prints the report. Raises ConfigError if FILE
    cannot be imported, and InputError if an output cannot be written."""
    from passo.config import shipped_boards
    from passo.config.findings import did_you_mean
    from passo.config.importing.formats import imported

    source = Path(arguments.file)
    output = Path(arguments.output or f"{source.stem}.toml")
    if output.exists():
        raise InputError.of("output.exists", str(output))
    board = arguments.board
    if board is not None and board not in shipped_boards():
        hint = did_you_mean(board, shipped_boards())
        raise ConfigError.of("import.no-board", hint=hint, value=board)
    stored = Path(arguments.stored) if arguments.stored else None
    draft = imported(source, stored, board=board)
    text = draft.text(f"Made by `passo import` from {source.name}. Each value names its line.")
    report = _report(draft.remarks)
    _write(output, text)
    if arguments.report:
        _write(Path(arguments.report), report)
    else:
        print(report, end="")
    if arguments.state:
        _store(draft, Path(arguments.state))
    print(f"{output}: written, {len(draft.keys)} values.", end=" ")
    print(f"Next: passo serve --machine {output}")
    return ExitStatus.DONE


def _store(draft: Draft, folder: Path) -> None:
    """Stores meshes and settings as a served printer does. Raises CommandError."""
    from passo.job.mesh_folder import MeshFolder
    from passo.job.settings_store import Override, Store, settings_in
    from passo.levelling.mesh import Mesh
    from passo.levelling.mesh_files import StoredMesh

    meshes = MeshFolder(folder / "meshes")
    for one in draft.meshes:
        heights = tuple(map(tuple, one.heights_mm))
        xs, ys = (
            tuple(low + (high - low) * i / (count - 1) for i in range(count))
            for (low, high), count in ((one.x_mm, len(heights[0])), (one.y_mm, len(heights)))
        )
        surface = "bicubic" if one.bicubic else "bilinear"
        meshes.save(StoredMesh(one.name, Mesh(xs, ys, heights), interpolation=surface))
    if draft.commands:
        folder.mkdir(parents=True, exist_ok=True)
        store = Store(folder / "settings.json", str(draft.keys["uuid",][0]))
        new = [Override(setting) for setting in settings_in(draft.commands)]
        keys = {override.setting.key for override in new}
        old = [one for one in store.load() or [] if one.setting.key not in keys]
        store.save([*old, *new])
    stored = [*(f"mesh {one.name}" for one in draft.meshes), *draft.commands]
    print(f"{folder}: stored {', '.join(stored) or 'nothing'}.")


def _report(remarks: list[Remark]) -> str:
    lines: list[str] = []
    for fate, heading in _HEADINGS.items():
        found = _joined([remark for remark in remarks if remark.fate == fate])
        if found:
            lines += [f"{heading}:", *found, ""]
    return "\n".join(lines) + ("\n" if lines else "")


def _joined(remarks: list[Remark]) -> list[str]:
    """A line for each text, with all places in a file to which it applies."""
    same: dict[tuple[str, str], list[Remark]] = {}
    for remark in remarks:
        same.setdefault((remark.place.file, remark.text), []).append(remark)
    lines: list[str] = []
    for (_, text), (first, *others) in same.items():
        places = ", ".join([str(first.place), *(str(other.place.line) for other in others)])
        parts = "; ".join(dict.fromkeys(remark.what for remark in (first, *others)))
        lines.append(f"  {places}: {parts}: {text}.")
    return lines


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        value = error.strerror or os.strerror(error.errno or 0)
        raise InputError.of("output.unwritable", str(path), value=value) from None
