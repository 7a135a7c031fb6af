"""The command table and the calls of hooks in C, and the data dictionary, from the declarations of
the sources."""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from passo.toolchain.declarations import (
    TASK_PHASES,
    Constant,
    DeclarationError,
    Declarations,
    gather,
    message_name,
)

# Only the numbers of `identify` and of its answer are fixed for all hosts.
_IDENTIFY_RESPONSE = 0
_FIRST_COMMAND = 1
_PARAMETERS_MAX = 12
_ONE_BYTE = 95  # the highest number that is encoded in one byte
# The functions of firmware/core/hooks.h, with the hooks that each of them calls.
_CALLERS = {
    "hooks_start": ("START", ("",)),
    "hooks_every_pass": ("TASK", TASK_PHASES[:1]),
    "hooks_task": ("TASK", TASK_PHASES[1:]),
    "hooks_shut_down": ("ON_SHUTDOWN", ("",)),
    "hooks_clear_shutdown": ("ON_CLEAR_SHUTDOWN", ("",)),
    "hooks_pool_empty": ("ON_POOL_EMPTY", ("",)),
}
_TYPES = {
    "%u": "LONG",
    "%i": "LONG",
    "%hu": "WORD",
    "%hi": "LONG",
    "%c": "BYTE",
    "%*s": "BYTES",
    "%.*s": "BYTES",
}


def command_numbers(found: Declarations) -> dict[str, int]:
    """The number of each command, by its format."""
    formats = [c.format for c in found.commands]
    formats.sort(key=lambda text: message_name(text) != "identify")
    return {text: _FIRST_COMMAND + i for i, text in enumerate(formats)}


def report_numbers(found: Declarations) -> dict[str, int]:
    """The number of each report, by its format."""
    formats = sorted(found.reports, key=lambda text: message_name(text) != "identify_response")
    first = _FIRST_COMMAND + len(found.commands)
    return {text: first + i - 1 if i > 0 else _IDENTIFY_RESPONSE for i, text in enumerate(formats)}


def shutdown_numbers(found: Declarations) -> dict[str, int]:
    """The number of each reason for a shutdown, by its C name."""
    return {name: 1 + i for i, name in enumerate(found.shutdowns)}


def dictionary(
    found: Declarations,
    *,
    version: str,
    app: str = "Passo",
    build_versions: str = "",
    constants: Mapping[str, Constant] | None = None,
    enumerations: Mapping[str, Mapping[str, int | tuple[int, int]]] | None = None,
) -> dict[str, Any]:
    """The data dictionary: the declarations of the sources plus the `constants` and `enumerations`
    of the build. An enumeration maps a name to a number, or to the first number and the count, as
    for pins."""
    shutdowns = shutdown_numbers(found)
    merged: dict[str, dict[str, int | list[int]]] = {}
    for name, keys in [*found.enumerations.items(), *(enumerations or {}).items()]:
        for key, value in keys.items():
            plain = list(value) if isinstance(value, tuple) else value
            merged.setdefault(name, {})[key] = plain
    merged["static_string_id"] = {text: shutdowns[name] for name, text in found.shutdowns.items()}
    return {
        "app": app,
        "version": version,
        "license": "Apache-2.0",
        "build_versions": build_versions,
        "commands": command_numbers(found),
        "responses": report_numbers(found),
        "enumerations": merged,
        "config": {**found.constants, **(constants or {})},
    }


def compress(content: Mapping[str, Any]) -> bytes:
    """Compresses a dictionary for an image; the same content gives the same bytes."""
    return zlib.compress(json.dumps(content, sort_keys=True, separators=(",", ":")).encode(), 9)


def write_board(
    sources: Sequence[Path],
    header: str,
    directory: Path,
    *,
    version: str,
    constants: Mapping[str, Constant],
    enumerations: Mapping[str, Mapping[str, int | tuple[int, int]]],
) -> tuple[dict[str, Any], list[Path]]:
    """Writes the tables of the declarations, and `header` as board.h, into `directory`. Returns the
    data dictionary and the tables' C sources. Raises DeclarationError."""
    found = gather(sources)
    content = dictionary(found, version=version, constants=constants, enumerations=enumerations)
    tables = write_tables(found, content, directory)
    _write(directory / "board.h", header)
    return content, tables


def write_tables(found: Declarations, content: Mapping[str, Any], directory: Path) -> list[Path]:
    """Writes declared.h and tables.c into `directory`; an unchanged file is not written. Returns
    the C sources. Raises DeclarationError."""
    directory.mkdir(parents=True, exist_ok=True)
    _write(directory / "declared.h", _header(found))
    source = directory / "tables.c"
    parts = [_table(found), _hooks(found), _dictionary_in_c(compress(content))]
    _write(source, "\n".join(parts))
    return [source]


def _write(path: Path, text: str) -> None:
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def _header(found: Declarations) -> str:
    reports = {message_name(text).upper(): n for text, n in report_numbers(found).items()}
    lines = [
        "// Made by the build from the declarations in the sources.",
        "#pragma once",
        f"#define COMMAND_FIRST {_FIRST_COMMAND}",
        f"#define COMMAND_COUNT {len(found.commands)}",
        *(
            f"#define COMMAND_{message_name(t).upper()} {n}"
            for t, n in command_numbers(found).items()
        ),
        *(f"#define REPORT_{name} {n}" for name, n in reports.items()),
        *(f"#define SHUTDOWN_{name} {n}" for name, n in shutdown_numbers(found).items()),
    ]
    if max(reports.values()) > _ONE_BYTE or len(found.shutdowns) > 255:
        raise DeclarationError("more messages or reasons than the firmware has numbers for")
    return "\n".join(lines) + "\n"


def _table(found: Declarations) -> str:
    by_format = {c.format: c for c in found.commands}
    rows: list[str] = []
    prototypes: list[str] = []
    for text, number in command_numbers(found).items():
        command = by_format[text]
        types = _types(text)
        packed = " | ".join(f"(uint32_t)TYPE_{t} << {2 * i}" for i, t in enumerate(types)) or "0"
        prototypes.append(f"void {command.handler}(const uint32_t *args);")
        rows.append(
            f"  [{number - _FIRST_COMMAND}] = {{{command.handler}, {packed}, {len(types)},"
            f" {command.flags}}},  // {message_name(text)}"
        )
    return "\n".join(
        [
            "// Made by the build from the declarations in the sources.",
            '#include "command.h"',
            '#include "hooks.h"',
            "",
            *prototypes,
            "",
            "const struct command HAL_CONST commands[COMMAND_COUNT] = {",
            *rows,
            "};",
            "",
        ]
    )


def _hooks(found: Declarations) -> str:
    """The functions of hooks.h."""
    hooks = {hook.function: "bool" if hook.kind == "WATCH" else "void" for hook in found.hooks}
    lines = [f"{type_} {function}(void);" for function, type_ in hooks.items()]
    for caller, (kind, phases) in _CALLERS.items():
        calls = (f"  {function}();" for function in found.called(kind, phases))
        lines += ["", f"void {caller}(void) {{", *calls, "}"]
    watches = [f"{function}()" for function in found.called("WATCH")]
    lines += ["", f"bool hooks_watch(void) {{ return {' || '.join(watches) or 'false'}; }}", ""]
    return "\n".join(lines)


def _types(text: str) -> list[str]:
    types: list[str] = []
    for word in text.split(" ")[1:]:
        name, _, conversion = word.partition("=")
        if not name or conversion not in _TYPES:
            raise DeclarationError(f"'{text}': '{word}' is no parameter")
        types.append(_TYPES[conversion])
    if len(types) > _PARAMETERS_MAX or types.count("BYTES") > 1:
        raise DeclarationError(f"'{text}': too many parameters, or bytes twice")
    return types


def _dictionary_in_c(compressed: bytes) -> str:
    lines = [
        "  " + " ".join(f"0x{byte:02x}," for byte in compressed[i : i + 16])
        for i in range(0, len(compressed), 16)
    ]
    return "\n".join(
        [
            "const uint8_t HAL_CONST dictionary[] = {",
            *lines,
            "};",
            "const uint16_t dictionary_size = sizeof dictionary;",
            "",
        ]
    )
